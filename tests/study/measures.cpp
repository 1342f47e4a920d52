// SPDX-License-Identifier: Apache-2.0
// Means, standard errors and ratios over seeds; points of a hypercube; results as text.
#include <algorithm>
#include <cmath>
#include <set>

#include "golden/numeric/random.hpp"
#include "study/collector.hpp"
#include "study/points.hpp"
#include "tests/catch.hpp"

using namespace photonloom;

namespace {

// Nearly normal, variance 1.
double noise(uint64_t seed, uint64_t i, uint64_t j) {
  double sum = 0;
  for (uint64_t n = 0; n < 12; ++n) sum += to_unit(hash_bits(seed, i, j, n));
  return sum - 6;
}

// relmse of a point: each block a mean of its own and noise of every seed; `shared` of it is the
// baseline's too.
Result made(uint64_t trial, uint64_t seed, double scale, double shared, uint64_t which) {
  Result r;
  r.key = {"s", "p", seed};
  Measurement& m = r.measures["visible"].figures;
  m.values = {0, 0, 0, 0};
  Blocks blocks(kBlocks);
  for (size_t j = 0; j < blocks.size(); ++j) {
    const double common = noise(trial, seed, j),
                 own = noise(trial + 1000000 * which, seed, j + 100);
    blocks[j] = scale * (1 + static_cast<double>(j % 5)) *
                (1 + 0.1 * (shared * common + std::sqrt(1 - shared * shared) * own));
    m.values[0] += blocks[j];
  }
  m.blocks["relmse"] = blocks;
  return r;
}

}  // namespace

TEST_CASE("stated standard errors are what means over other seeds show") {
  double error2 = 0, ratio_error2 = 0, sum = 0, sum2 = 0, ratio_sum = 0, ratio_sum2 = 0;
  const int trials = 400;
  for (int t = 0; t < trials; ++t) {
    std::vector<Result> point, baseline;
    for (const uint64_t seed : {1, 2, 3}) {
      point.push_back(made(static_cast<uint64_t>(t), seed, 2, 0.8, 1));
      baseline.push_back(made(static_cast<uint64_t>(t), seed, 1, 0.8, 2));
    }
    const Mean m = means_of(point, baseline).at("visible.relmse");
    error2 += m.error * m.error;
    ratio_error2 += m.ratio_error * m.ratio_error;
    sum += m.mean;
    sum2 += m.mean * m.mean;
    ratio_sum += m.ratio;
    ratio_sum2 += m.ratio * m.ratio;
  }
  const double n = trials;
  const double spread = std::sqrt((sum2 - sum * sum / n) / (n - 1));
  const double ratio_spread = std::sqrt((ratio_sum2 - ratio_sum * ratio_sum / n) / (n - 1));
  CHECK(std::sqrt(error2 / n) == Approx(spread).epsilon(0.15));
  CHECK(std::sqrt(ratio_error2 / n) == Approx(ratio_spread).epsilon(0.15));
  CHECK(ratio_sum / n == Approx(2).epsilon(0.01));
  // The same seeds: the ratio knows more than the two means do.
  CHECK(ratio_spread / 2 < spread / (sum / n));
}

TEST_CASE("the baseline's ratio to itself is one, without error") {
  std::vector<Result> point;
  for (const uint64_t seed : {1, 2, 3}) point.push_back(made(5, seed, 1, 0.5, 1));
  const Mean m = means_of(point, point).at("visible.relmse");
  CHECK(m.ratio == 1);
  CHECK(m.ratio_error == 0);
  CHECK(m.error > 0);
}

TEST_CASE("a Latin hypercube takes each part of each line once") {
  const std::vector<LineChoice> choices = {
      {"gather.k", {}, 1, 20, true, false},
      {"radius_scale", {}, 0.5, 2.0, false, true},
      {"gatherer.lanes", {"1", "2", "4", "8"}, 0, 0, true, false}};
  const auto points = latin_hypercube(choices, 20, 3);
  REQUIRE(points.size() == 20);
  std::set<std::string> ks;
  std::map<std::string, int> lanes;
  std::set<int> parts;
  for (const LineValues& p : points) {
    ks.insert(p[0].second);
    ++lanes[p[2].second];
    parts.insert(static_cast<int>(20 * std::log(std::stod(p[1].second) / 0.5) / std::log(4.0)));
  }
  CHECK(ks.size() == 20);
  CHECK(parts.size() == 20);
  for (const char* v : {"1", "2", "4", "8"}) CHECK(lanes[v] == 5);
  CHECK(points == latin_hypercube(choices, 20, 3));
  CHECK(points != latin_hypercube(choices, 20, 4));
}

TEST_CASE("a result reads back as it was written, and any changed byte is seen") {
  Result r = made(1, 2, 1, 0, 1);
  r.measures["visible"].settings = "references 0123";
  r.measures["gather"].figures.values = {std::nan(""), 0.1};
  r.seconds = 1.25;
  const std::string text = result_text(r);
  const Result back = parse_result(text);
  CHECK(result_text(back) == text);
  CHECK(back.key == r.key);
  CHECK(back.measures.at("visible").figures.blocks == r.measures.at("visible").figures.blocks);
  CHECK(std::isnan(back.measures.at("gather").figures.values[0]));
  for (size_t i = 0; i < text.size(); ++i) {
    std::string damaged = text;
    damaged[i] = static_cast<char>(damaged[i] ^ 4);
    CHECK_THROWS_AS(parse_result(damaged), std::runtime_error);
    CHECK_THROWS_AS(parse_result(text.substr(0, i)), std::runtime_error);
  }
}
