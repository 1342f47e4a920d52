// SPDX-License-Identifier: Apache-2.0
// Queries per second of the golden gather beside nanoflann, FLANN and CGAL: one thread, the same
// quantised points, the same run; and of golden on all cores in that run. See docs/photon_map.md
// for what is measured and how.
#include <fmt/core.h>
#include <malloc.h>
#include <sched.h>
#include <time.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>

#include "bench/contender.hpp"
#include "bench/room.hpp"
#include "golden/numeric/hilbert.hpp"
#include "golden/numeric/random.hpp"
#include "golden/unit/gather_search.hpp"
#include "verilator_tb/rig/number_options.hpp"

namespace photonloom::bench {

double now() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

double heap_bytes() {
  const struct mallinfo2 info = mallinfo2();
  return static_cast<double>(info.uordblks) + static_cast<double>(info.hblkhd);
}

namespace {

constexpr int kRepetitions = 7;
constexpr uint64_t kSeed = 1;
constexpr size_t kGatherRays = 16;

struct Options {
  std::vector<size_t> sizes = {10000, 100000, 1000000};
  std::vector<uint32_t> ks = {8, 50, 200};
  size_t queries = 16384;  // of a timed repetition
  size_t trial = 2048;     // queries on which a library's configurations compete
  std::string json;
};

struct Order {
  const char* name;
  std::vector<UVec3> queries;
};

std::vector<Order> make_orders(size_t n) {
  const std::vector<UVec3> gather = gather_hits(n, kGatherRays, kSeed);
  std::vector<UVec3> random = gather, hilbert = gather;
  for (size_t i = n - 1; i > 0; --i)
    std::swap(random[i], random[hash_bits(kSeed, i, 0, 0) % (i + 1)]);
  std::sort(hilbert.begin(), hilbert.end(), [](const UVec3& a, const UVec3& b) {
    return hilbert_index(a, kPositionBits) < hilbert_index(b, kPositionBits);
  });
  return {{"random", random},
          {"scanline", camera_hits(n)},
          {"hilbert", hilbert},
          {"final gather", gather}};
}

Found make_found(uint32_t k, size_t queries) {
  Found found;
  found.k = k;
  found.index.resize(k * queries);
  found.d2.resize(k * queries);
  found.count.resize(queries);
  found.r2.resize(queries);
  return found;
}

double time_search(const Contender& contender, const std::vector<UVec3>& queries, size_t end,
                   int64_t r2_max, Found& found) {
  const double start = now();
  contender.search(queries, 0, end, r2_max, found);
  return (now() - start) / static_cast<double>(end);
}

double wall() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double process_seconds() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

// Threads that this process may run at a time.
unsigned machine_threads() {
  cpu_set_t set;
  return sched_getaffinity(0, sizeof set, &set) == 0 ? static_cast<unsigned>(CPU_COUNT(&set)) : 1;
}

// Of all threads together: seconds of the clock on the wall a query, and which part of what they
// could have had of the cores they got; the rest went to other programs.
struct OnAllCores {
  double seconds, share;
};

// Each thread takes some hundred queries at a time.
OnAllCores time_threads(const Contender& contender, const std::vector<UVec3>& queries,
                        int64_t r2_max, unsigned threads, Found& found) {
  constexpr size_t kAtATime = 512;
  std::atomic<size_t> next{0};
  const auto work = [&] {
    for (size_t begin = next.fetch_add(kAtATime); begin < queries.size();
         begin = next.fetch_add(kAtATime))
      contender.search(queries, begin, std::min(begin + kAtATime, queries.size()), r2_max, found);
  };
  const double start = wall(), cpu = process_seconds();
  std::vector<std::thread> others;
  for (unsigned i = 1; i < threads; ++i) others.emplace_back(work);
  work();
  for (std::thread& other : others) other.join();
  const double took = wall() - start;
  return {took / static_cast<double>(queries.size()), (process_seconds() - cpu) / (took * threads)};
}

uint64_t square_distance(const UVec3& a, const UVec3& b) {
  uint64_t d2 = 0;
  for (size_t c = 0; c < 3; ++c) {
    const int64_t d = int64_t{a[c]} - int64_t{b[c]};
    d2 += static_cast<uint64_t>(d * d);
  }
  return d2;
}

// Distances that a float cannot tell apart are ties for a library that computes
// in float: its squares and sums are each off by at most half an ulp.
bool tied(uint64_t a, uint64_t b) {
  const double x = static_cast<double>(a), y = static_cast<double>(b);
  return std::fabs(x - y) <= std::ldexp(std::max(x, y), -22);
}

// Whether a library found the same as golden, up to ties, by exact distances of
// the indices it gave.
void check_same(const Contender& own, const Contender& contender, const std::vector<UVec3>& points,
                const std::vector<UVec3>& queries, int64_t r2_max, const Found& golden,
                const Found& other) {
  std::vector<uint64_t> a, b;
  const uint32_t k = golden.k;
  for (size_t i = 0; i < queries.size(); ++i) {
    const auto distances = [&](const Contender& by, const Found& found, std::vector<uint64_t>& d2) {
      d2.clear();
      for (uint32_t j = 0; j < found.count[i]; ++j)
        d2.push_back(square_distance(points[by.number(found.index[i * k + j])], queries[i]));
      std::sort(d2.begin(), d2.end());
    };
    distances(own, golden, a);
    distances(contender, other, b);
    bool same = true;
    const size_t common = std::min(a.size(), b.size());
    for (size_t j = 0; j < common; ++j) same &= tied(a[j], b[j]);
    for (const auto* longer : {&a, &b})
      for (size_t j = common; j < longer->size(); ++j)
        same &= r2_max >= 0 && tied((*longer)[j], static_cast<uint64_t>(r2_max));
    if (a.size() == k && b.size() == k)
      same &= tied(static_cast<uint64_t>(golden.r2[i]), static_cast<uint64_t>(other.r2[i]));
    if (!same) {
      fmt::print(stderr,
                 "bench: {} ({}) and photonloom differ in query {} at ({}, {}, "
                 "{}), k {}\n",
                 contender.library(), contender.configuration(), i, queries[i][0], queries[i][1],
                 queries[i][2], k);
      std::exit(1);
    }
  }
}

// Part of the k nearest, as a library found them, that golden found too: photons no further than
// the library's furthest, up to ties.
double recall_of(const Contender& own, const Contender& library, const std::vector<UVec3>& points,
                 const std::vector<UVec3>& queries, const Found& golden, const Found& exact) {
  uint64_t wanted = 0, found = 0;
  for (size_t i = 0; i < queries.size(); ++i) {
    const auto distance = [&](const Contender& by, const Found& of, uint32_t j) {
      return square_distance(points[by.number(of.index[i * of.k + j])], queries[i]);
    };
    uint64_t furthest = 0;
    for (uint32_t j = 0; j < exact.count[i]; ++j)
      furthest = std::max(furthest, distance(library, exact, j));
    uint32_t within = 0;
    for (uint32_t j = 0; j < golden.count[i]; ++j) {
      const uint64_t d2 = distance(own, golden, j);
      within += d2 <= furthest || tied(d2, furthest);
    }
    wanted += exact.count[i];
    found += std::min(within, exact.count[i]);
  }
  return wanted ? static_cast<double>(found) / static_cast<double>(wanted) : 1;
}

double median(std::vector<double> x) {
  std::sort(x.begin(), x.end());
  return x[x.size() / 2];
}

// Times of one cell, seconds a query of each repetition, and each library's best configuration.
struct Cell {
  std::map<std::string, std::vector<double>> times;
  std::map<std::string, std::pair<double, const Contender*>> best;
  std::vector<double> ratios;     // best library / golden, a repetition each
  std::vector<double> all_cores;  // golden with `threads`
  std::vector<double> share;      // of the cores, while all were timed
  unsigned threads = 0;
  double recall = 1;  // of golden, beside the libraries' exact answers
};

// all: golden, then the libraries. checked: golden that is exact, which the libraries are compared
// with; golden itself unless it has a leaf limit.
Cell time_cell(const Contenders& all, const Contender& checked, const std::vector<UVec3>& points,
               const std::vector<UVec3>& queries, uint32_t k, int64_t r2_max, size_t trial) {
  Cell cell;
  cell.threads = machine_threads();
  const Contender& golden = *all[0];
  Found found = make_found(k, queries.size()), other = make_found(k, queries.size());
  Found exact = make_found(k, queries.size());
  checked.search(queries, 0, queries.size(), r2_max, exact);
  // Each library's best configuration, on the first queries, second of two runs.
  for (size_t i = 1; i < all.size(); ++i) {
    double seconds = 0;
    for (int run = 0; run < 2; ++run) seconds = time_search(*all[i], queries, trial, r2_max, other);
    auto& entry = cell.best[all[i]->library()];
    if (!entry.second || seconds < entry.first) entry = {seconds, all[i].get()};
  }
  // Interleaved repetitions; the first, which also warms up and is checked, does not count.
  for (int repetition = -1; repetition < kRepetitions; ++repetition) {
    const OnAllCores on_all = time_threads(golden, queries, r2_max, cell.threads, found);
    const double own = time_search(golden, queries, queries.size(), r2_max, found);
    double least = INFINITY;
    for (const auto& [library, entry] : cell.best) {
      const double seconds = time_search(*entry.second, queries, queries.size(), r2_max, other);
      if (repetition < 0) {
        check_same(checked, *entry.second, points, queries, r2_max, exact, other);
        cell.recall = recall_of(golden, *entry.second, points, queries, found, other);
      }
      if (repetition >= 0) cell.times[library].push_back(seconds);
      least = std::min(least, seconds);
    }
    if (repetition < 0) continue;
    cell.times["photonloom"].push_back(own);
    cell.all_cores.push_back(on_all.seconds);
    cell.share.push_back(on_all.share);
    cell.ratios.push_back(least / own);
  }
  return cell;
}

// Queries a second of so many seconds a query.
nlohmann::ordered_json spread(const std::vector<double>& seconds) {
  const auto [least, most] = std::minmax_element(seconds.begin(), seconds.end());
  return {{"least", 1 / *most},
          {"median", 1 / median(seconds)},
          {"most", 1 / *least},
          {"runs", seconds.size()}};
}

void add_rates(const Cell& cell, nlohmann::ordered_json& to) {
  for (const auto& [library, seconds] : cell.times) {
    to["queries_per_second"][library] = 1 / median(seconds);
    to["spread"][library] = spread(seconds);
    const auto best = cell.best.find(library);
    if (best != cell.best.end())
      to["configuration"][library] = best->second.second->configuration();
  }
  to["all_cores"] = spread(cell.all_cores);
  to["all_cores"]["threads"] = cell.threads;
  to["all_cores"]["share"] = median(cell.share);
  to["recall"] = cell.recall;
}

Contenders make_contenders(const std::vector<UVec3>& points, const GoldenSearch& how = {}) {
  Contenders all;
  all.push_back(make_photonloom(points, how));
  add_nanoflann(points, all);
  add_flann(points, all);
  add_cgal(points, all);
  return all;
}

int write_report(const std::string& path, const nlohmann::ordered_json& report) {
  std::ofstream file(path);
  file << report.dump(1) << '\n';
  if (file.flush()) return 0;
  fmt::print(stderr, "bench: cannot write {}\n", path);
  return 1;
}

// Positions from a file: three little-endian words of 32 bits each.
std::vector<UVec3> read_positions(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::vector<UVec3> positions;
  unsigned char bytes[12];
  while (file.read(reinterpret_cast<char*>(bytes), sizeof bytes)) {
    UVec3 p{};
    for (int axis = 0; axis < 3; ++axis)
      for (int byte = 0; byte < 4; ++byte)
        p[axis] |= static_cast<uint32_t>(bytes[4 * axis + byte]) << (8 * byte);
    positions.push_back(p);
  }
  if (positions.empty() || file.gcount() != 0) {
    fmt::print(stderr, "bench: {}: expected positions of 12 bytes each\n", path);
    std::exit(1);
  }
  return positions;
}

// One cloud of photons and its queries from files, without a radius and with those given.
int run_cloud(const std::string& json, const std::string& photons, const std::string& queries_file,
              uint32_t k, const std::vector<int64_t>& radii, const GoldenSearch& how) {
  const std::vector<UVec3> points = read_positions(photons);
  const std::vector<UVec3> queries = read_positions(queries_file);
  const Contenders all = make_contenders(points, how);
  const std::unique_ptr<Contender> exact = how.leaf_limit ? make_photonloom(points) : nullptr;
  nlohmann::ordered_json report;
  for (const int64_t r2_max : radii) {
    const Cell cell = time_cell(all, exact ? *exact : *all[0], points, queries, k, r2_max,
                                std::min<size_t>(2048, queries.size()));
    nlohmann::ordered_json row = {
        {"photons", points.size()},
        {"queries", queries.size()},
        {"k", k},
        {"leaf_limit", how.leaf_limit},
        {"r2_max", r2_max < 0 ? nlohmann::ordered_json() : nlohmann::ordered_json(r2_max)}};
    add_rates(cell, row);
    report.push_back(row);
  }
  return write_report(json, report);
}

// Even in the whole cube.
std::vector<UVec3> uniform_points(size_t n, uint64_t seed) {
  std::vector<UVec3> points(n);
  for (size_t i = 0; i < n; ++i)
    for (uint32_t axis = 0; axis < 3; ++axis)
      points[i][static_cast<int>(axis)] =
          static_cast<uint32_t>(hash_bits(seed, i, 0, axis) >> (64 - kPositionBits));
  return points;
}

// The workload that a library publishes: points and queries even in a cube, in no order, no radius.
int run_uniform(const std::string& json, const std::vector<size_t>& sizes,
                const std::vector<uint32_t>& ks, size_t count) {
  nlohmann::ordered_json report;
  const std::vector<UVec3> queries = uniform_points(count, kSeed + 1);
  fmt::print("us per query, median of {}; uniform points and queries\n", kRepetitions);
  for (const size_t n : sizes) {
    const std::vector<UVec3> points = uniform_points(n, kSeed);
    const Contenders all = make_contenders(points);
    for (const uint32_t k : ks) {
      const Cell cell =
          time_cell(all, *all[0], points, queries, k, -1, std::min<size_t>(2048, count));
      nlohmann::ordered_json row = {{"points", n}, {"queries", count}, {"k", k}};
      add_rates(cell, row);
      fmt::print("{:>8} {:>4}", n, k);
      for (const auto& [library, seconds] : cell.times)
        fmt::print("  {} {:.3f}", library, 1e6 * median(seconds));
      fmt::print("\n");
      std::fflush(stdout);
      report.push_back(row);
    }
  }
  return write_report(json, report);
}

int run(const Options& options) {
  nlohmann::ordered_json report;
  report["what"] = "k nearest photons, one thread; ratio = best library's time / golden's";
  report["repetitions"] = kRepetitions;
  report["queries"] = options.queries;
  report["cells"] = nlohmann::ordered_json::array();
  report["builds"] = nlohmann::ordered_json::array();
  const std::vector<Order> orders = make_orders(options.queries);
  int cells = 0, won = 0;
  for (const size_t n : options.sizes) {
    const std::vector<UVec3> points = trace_photons(n, kSeed);
    const Contenders all = make_contenders(points);
    fmt::print("\n{} photons\n{:<11} {:<24} {:>9} {:>13}\n", n, "", "configuration", "build s",
               "bytes/photon");
    for (const auto& c : all) {
      fmt::print("{:<11} {:<24} {:>9.3f} {:>13.1f}\n", c->library(), c->configuration(),
                 c->build_seconds(), c->bytes_per_point());
      report["builds"].push_back({{"photons", n},
                                  {"library", c->library()},
                                  {"configuration", c->configuration()},
                                  {"build_seconds", c->build_seconds()},
                                  {"bytes_per_photon", c->bytes_per_point()}});
    }
    fmt::print(
        "\nus per query, median of {}; ratio = best library / "
        "photonloom, median (range)\n",
        kRepetitions);
    fmt::print("{:>8} {:>4} {:<7} {:<13} {:>10} {:>10} {:>10} {:>10}  {:<22} {}\n", "photons", "k",
               "radius", "order", "photonloom", "nanoflann", "FLANN", "CGAL", "ratio", "");
    for (const uint32_t k : options.ks)
      for (const bool with_radius : {false, true}) {
        // The radius within which a map of even density holds k photons.
        const int64_t r2_max =
            with_radius ? static_cast<int64_t>(k * surface_area() / (M_PI * static_cast<double>(n)))
                        : -1;
        for (const Order& order : orders) {
          const Cell cell_times =
              time_cell(all, *all[0], points, order.queries, k, r2_max, options.trial);
          const std::vector<double>& ratios = cell_times.ratios;
          const double ratio = median(ratios);
          const double low = *std::min_element(ratios.begin(), ratios.end());
          const double high = *std::max_element(ratios.begin(), ratios.end());
          ++cells;
          won += ratio > 1;
          const auto micro = [&](const char* library) {
            return 1e6 * median(cell_times.times.at(library));
          };
          fmt::print(
              "{:>8} {:>4} {:<7} {:<13} {:>10.3f} {:>10.3f} {:>10.3f} "
              "{:>10.3f}  {:<22} {}\n",
              n, k, with_radius ? "yes" : "no", order.name, micro("photonloom"), micro("nanoflann"),
              micro("FLANN"), micro("CGAL"),
              fmt::format("{:.2f} ({:.2f} to {:.2f})", ratio, low, high),
              ratio > 1 ? "won" : "LOST");
          std::fflush(stdout);
          nlohmann::ordered_json cell = {{"photons", n},          {"k", k},
                                         {"radius", with_radius}, {"r2_max", r2_max},
                                         {"order", order.name},   {"ratio", ratio},
                                         {"ratio_low", low},      {"ratio_high", high},
                                         {"won", ratio > 1}};
          add_rates(cell_times, cell);
          report["cells"].push_back(cell);
        }
      }
  }
  fmt::print("\n{} of {} cells won\n", won, cells);
  report["won"] = won;
  return write_report(options.json, report);
}

}  // namespace
}  // namespace photonloom::bench

int main(int argc, char** argv) {
  using namespace photonloom::bench;
  Options o;
  CLI::App app{
      "Queries a second of the golden gather beside nanoflann, FLANN and CGAL, into a JSON file: "
      "of photons in a room, of positions from files, or of uniform points.",
      "bench_gather"};
  const auto count = photonloom::number_range(1, 1e9);
  const auto k = photonloom::number_range(1, photonloom::search::kMaxK);
  std::vector<std::string> cloud;
  bool uniform = false;
  int64_t r2_max = 0;
  GoldenSearch how;
  app.add_option("json", o.json, "the file to write")->type_name("FILE")->required();
  auto* const from_files =
      app.add_option("--cloud", cloud, "positions of photons and of queries, files")
          ->type_name("PHOTONS QUERIES")
          ->expected(2)
          ->check(CLI::ExistingFile);
  app.add_flag("--uniform", uniform, "points and queries even in a cube")->excludes(from_files);
  app.add_option("--queries", o.queries, "of a repetition, with --cloud all")
      ->check(count)
      ->excludes(from_files)
      ->capture_default_str();
  app.add_option("--photons", o.sizes, "how many; several with commas")
      ->check(count)
      ->delimiter(',')
      ->allow_extra_args(false)
      ->excludes(from_files)
      ->capture_default_str();
  auto* const ks = app.add_option("-k", o.ks, "nearest photons; several with commas")
                       ->check(k)
                       ->delimiter(',')
                       ->allow_extra_args(false)
                       ->capture_default_str();
  app.add_option("--r2-max", r2_max, "with --cloud: also within this squared distance")
      ->check(photonloom::number_range(1, 9e18))
      ->needs(from_files);
  auto* const limit =
      app.add_option("--leaf-limit", how.leaf_limit,
                     "with --cloud: golden visits so many leaves at most, 0 for all")
          ->check(photonloom::number_range(0, 1e9))
          ->needs(from_files);
  auto* const bucket =
      app.add_option("--bucket", how.bucket, "photons of a leaf")->check(count)->needs(limit);
  limit->needs(bucket);
  photonloom::check_values(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  if (!cloud.empty()) {
    if (o.ks.size() != 1 || ks->count() == 0) {
      fmt::print(stderr, "bench_gather: -k: expected one with --cloud\n");
      return 2;
    }
    std::vector<int64_t> radii = {-1};
    if (r2_max > 0) radii.push_back(r2_max);
    return run_cloud(o.json, cloud[0], cloud[1], o.ks[0], radii, how);
  }
  if (uniform) return run_uniform(o.json, o.sizes, o.ks, o.queries);
  o.trial = std::min(o.trial, o.queries);
  return run(o);
}
