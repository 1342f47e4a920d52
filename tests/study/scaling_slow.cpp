// SPDX-License-Identifier: Apache-2.0
// What a store of many results costs, simulated: writing, looking for what is undone, collecting.
// The figures of docs/scaling.md are what this prints.
#include <fmt/core.h>

#include <chrono>
#include <cstdlib>
#include <ctime>
#include <filesystem>

#include "golden/numeric/random.hpp"
#include "study/collector.hpp"
#include "tests/catch.hpp"
#include "tests/command/run.hpp"

using namespace photonloom;

namespace {

double seconds(const std::chrono::steady_clock::time_point& since) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - since).count();
}

// As many as the environment asks for, 100,000 unless it does.
size_t wanted() {
  const char* n = std::getenv("PHOTONLOOM_RESULTS");
  return n ? std::strtoul(n, nullptr, 10) : 100000;
}

}  // namespace

TEST_CASE("100,000 results are collected, each once") {
  const photonloom::test::Scratch s;
  const ResultStore store(s / "store");
  PointTable table;
  table.study = "simulated";
  table.seeds = {1, 2, 3, 4};
  for (const Measure& m : measures()) table.measures.emplace_back(m.name);
  table.scenes.push_back({"scene", "scene.xml", "0123456789abcdef", "", "signature", 1e-4});
  const size_t results = wanted(), points = results / table.seeds.size();
  auto start = std::chrono::steady_clock::now();
  uint64_t bytes = 0;
  for (size_t i = 0; i < points; ++i) {
    PlannedPoint p;
    p.point.number = static_cast<uint32_t>(i);
    p.point.origin = "grid";
    p.point.lines = {{"gather.k", std::to_string(i)}, {"photon.position_bits", "12"}};
    p.plan = fmt::format("{:016x}", hash_bits(1, i, 0, 0));
    p.command = "photonloom plan scene.xml -o plan.toml";
    for (const uint64_t seed : table.seeds) {
      Result r;
      r.key = {table.scenes[0].hash, p.plan, seed};
      r.seconds = 1;
      for (const Measure& m : measures()) {
        Result::Taken& taken = r.measures[m.name];
        taken.settings = "1";
        uint64_t column = 0;
        for (const Column& c : m.columns) {
          const double x = to_unit(hash_bits(seed, i, ++column, 0));
          taken.figures.values.push_back(x);
          // As real ones have.
          if (column <= 3 && (taken.figures.values.size() == column) && m.columns.size() < 8 &&
              std::string(c.name) != "worst")
            for (int j = 0; j < kBlocks; ++j)
              taken.figures.blocks[c.name].push_back(
                  to_unit(hash_bits(seed, i, column, static_cast<uint64_t>(j))) / kBlocks);
        }
      }
      bytes += result_text(r).size();
      store.put(r);
    }
    table.points.push_back(std::move(p));
  }
  const double writing = seconds(start);
  start = std::chrono::steady_clock::now();
  size_t there = 0;
  for (const PlannedPoint& p : table.points)
    for (const uint64_t seed : table.seeds)
      there += store.find({table.scenes[0].hash, p.plan, seed}).has_value();
  const double looking = seconds(start);
  CHECK(there == points * table.seeds.size());
  start = std::chrono::steady_clock::now();
  const std::clock_t clock = std::clock();
  const CollectReport report =
      collect(table, store, [](const PlannedPoint&, Result&) { return true; });
  const double processor = static_cast<double>(std::clock() - clock) / CLOCKS_PER_SEC;
  const double collecting = seconds(start);
  CHECK(report.results == points * table.seeds.size());
  CHECK(report.missing == 0);
  fmt::print(
      "{} results: {:.1f} s to write ({:.1f} KB each), {:.1f} s to look through, {:.1f} s to "
      "collect (goal 60; {:.1f} s of the processor); results.sqlite {} MB, summary.json {} MB\n",
      report.results, writing,
      static_cast<double>(bytes) / 1e3 / static_cast<double>(report.results), looking, collecting,
      processor, std::filesystem::file_size(s / "store/results.sqlite") / 1000000,
      std::filesystem::file_size(s / "store/summary.json") / 1000000);
}
