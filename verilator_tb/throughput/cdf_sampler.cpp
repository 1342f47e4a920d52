// SPDX-License-Identifier: Apache-2.0
// Cycles of the CDF sampler: of building a table, of a whole table with its samples, and between
// the samples of a table while the next one is built. Input and output never stall; every packet is
// compared with golden.
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "golden/numeric/output_file.hpp"
#include "golden/plan/plan_file.hpp"
#include "verilator_tb/rig/number_options.hpp"
#include "verilator_tb/unit/backends.hpp"

namespace photonloom {
namespace {

struct Options {
  int cell_bits = 4, tables = 200;
  uint64_t seed = 1;
  std::string json, work = "build/cosim";
};

std::vector<SamplerInput> make_stream(const Plan& plan, int tables, int photons, int samples,
                                      uint64_t seed) {
  RoleRandom random(seed, "stream");
  const auto field = [&](int bits) { return static_cast<uint32_t>(random.bits() & ones(bits)); };
  std::vector<SamplerInput> in;
  for (int t = 0; t < tables; ++t) {
    SamplerInput header{};
    header.pixel = static_cast<uint32_t>(t) & static_cast<uint32_t>(ones(plan.pixel_bits()));
    header.normal = {field(plan.normal_bits), field(plan.normal_bits)};
    in.push_back(header);
    for (int i = 0; i < photons; ++i) {
      SamplerInput p{};
      p.kind = 1;
      for (int c = 0; c < plan.channels; ++c)
        p.mantissa[static_cast<size_t>(c)] = field(plan.mantissa_bits);
      p.exponent = field(plan.exponent_bits);
      p.direction = {field(plan.direction_bits), field(plan.direction_bits)};
      in.push_back(p);
    }
    for (int i = 0; i < samples; ++i) {
      SamplerInput p{};
      p.kind = 2;
      p.u = random.bits() & ones(plan.u_bits);
      p.v = {field(plan.v_bits), field(plan.v_bits)};
      in.push_back(p);
    }
  }
  return in;
}

int run(const Options& o) {
  Plan plan;
  plan.cell_bits = o.cell_bits;
  plan.u_bits = std::max(plan.u_bits, plan.total_bits() + 8);
  check_plan(plan);
  const int cells = 1 << (2 * plan.cell_bits);
  nlohmann::json rows = nlohmann::json::array();
  bool all_met = true;
  fmt::print("cdf_sampler: {} cells, {} tables\n", cells, o.tables);
  fmt::print("{:>7} {:>7} {:>12} {:>5} {:>14} {:>5} {:>12} {}\n", "photons", "samples",
             "build cycles", "goal", "cycles/sample", "goal", "cycles/table", "");
  for (const int photons : {0, 1, 8, 16, 50})
    for (const int samples : {16, 64}) {
      const std::vector<SamplerInput> in = make_stream(plan, o.tables, photons, samples, o.seed);
      std::vector<Sample> expected, out;
      make_golden_cdf_sampler(plan)->process(in, expected);
      RunOptions options;
      options.work_dir = o.work;
      options.timeline = true;
      const auto rtl = make_rtl_cdf_sampler(plan, options);
      rtl->process(in, out);
      if (out != expected) throw std::runtime_error("RTL and golden differ");
      const double tables = o.tables;
      const double build = static_cast<double>(rtl->counters().at("cycles building")) / tables;
      // Every table's samples but the last one's come out while the next table is built.
      const auto taken = rtl->in_cycles(), given = rtl->out_cycles(0);
      const size_t packets = static_cast<size_t>(1 + photons + samples);
      uint64_t longest = 0;
      for (size_t t = 0; t + 1 < static_cast<size_t>(o.tables); ++t) {
        const size_t first = t * static_cast<size_t>(samples);
        const size_t last = first + static_cast<size_t>(samples) - 1;
        longest = std::max(longest, given[last] - given[first]);
        if (given[first] < taken[(t + 1) * packets] && photons > 0)
          throw std::runtime_error("a table was sampled before the next one's header came");
      }
      const double per_sample = static_cast<double>(longest) / (samples - 1);
      const double per_table = static_cast<double>(given.back() - taken.front()) / tables;
      const int goal = photons + cells + 16;
      const bool met = build <= goal && per_sample <= 1;
      all_met &= met;
      fmt::print("{:>7} {:>7} {:>12.1f} {:>5} {:>14.2f} {:>5} {:>12.1f} {}\n", photons, samples,
                 build, goal, per_sample, 1, per_table, met ? "" : "MISSED");
      std::fflush(stdout);
      rows.push_back({{"photons", photons},
                      {"samples", samples},
                      {"cells", cells},
                      {"build_cycles", build},
                      {"build_goal", goal},
                      {"cycles_per_sample", per_sample},
                      {"cycles_per_table", per_table}});
    }
  if (!o.json.empty()) write_file(o.json, nlohmann::json{{"cdf_sampler", rows}}.dump(2) + "\n");
  return all_met ? 0 : 1;
}

}  // namespace
}  // namespace photonloom

int main(int argc, char** argv) {
  photonloom::Options o;
  CLI::App app{"Cycles of the RTL CDF sampler; exit status 1 where a goal is missed."};
  app.add_option("--cell-bits", o.cell_bits, "The table has 2^this x 2^this cells.");
  app.add_option("--tables", o.tables, "Tables of each kind.")->check(CLI::Range(2, 1 << 20));
  photonloom::add_seed_option(app, o.seed, "Seed.");
  app.add_option("--json", o.json, "Write the table here too.");
  app.add_option("--work", o.work, "Folder of Verilated models.");
  photonloom::check_values(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  try {
    return photonloom::run(o);
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
}
