// SPDX-License-Identifier: Apache-2.0
#include "verilator_tb/unit/drawn_run.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <stdexcept>

#include "golden/unit/photon_lines.hpp"
#include "hls_kernels/generate/recording.hpp"

namespace photonloom {

namespace {

void expect_equal(bool equal, const std::string& unit, const RunOptions& options) {
  if (!equal)
    throw std::runtime_error(fmt::format("{} as {}: packets differ from golden's; expected none",
                                         unit, model_kind_name(options.kind)));
}

// By Little's law: the time that packets take, over the time of the run.
double mean_in_flight(const Clocked& clocked, uint64_t cycles) {
  const std::span<const uint64_t> in = clocked.in_cycles(), out = clocked.out_cycles(0);
  uint64_t sum = 0;
  for (size_t i = 0; i < std::min(in.size(), out.size()); ++i) sum += out[i] - in[i];
  return static_cast<double>(sum) / static_cast<double>(std::max<uint64_t>(1, cycles));
}

double lines_a_leaf(const Plan& plan, const PhotonMap& map, bool is_caustic) {
  uint64_t further = 0;
  for (const auto& [leaf, lines] : further_lines(plan, map, is_caustic)) further += lines.size();
  return 1 + static_cast<double>(further) / std::max<uint64_t>(1, map.lines);
}

template <class Unit>
DrawnRun run_stream(std::type_identity<Unit> unit, const Plan& plan, const RunOptions& options) {
  const auto in = drawn_packets(unit, plan);
  std::vector<typename Unit::FirstOut> due, out;
  make_golden(unit, plan)->process(in, due);
  const auto clocked = make_rtl(unit, plan, options);
  const uint64_t before = clocked->cycles();
  clocked->process(in, out);
  expect_equal(out == due, unit_name<Unit>, options);
  return {in.size(), clocked->cycles() - before, trip_counts(plan, in), clocked->counters(), 0};
}

}  // namespace

DrawnRun run_drawn(std::type_identity<ReorderBuffer> unit, const Plan& plan,
                   const RunOptions& options) {
  return run_stream(unit, plan, options);
}

DrawnRun run_drawn(std::type_identity<CdfSampler> unit, const Plan& plan,
                   const RunOptions& options) {
  return run_stream(unit, plan, options);
}

DrawnRun run_drawn(std::type_identity<IrradianceCache> unit, const Plan& plan,
                   const RunOptions& options) {
  return run_stream(unit, plan, options);
}

DrawnRun run_drawn(std::type_identity<PhotonGatherer> unit, const Plan& plan,
                   const RunOptions& options) {
  const std::vector<PhotonMap> maps = drawn_maps(plan);
  const std::vector<GatherQuery> in = drawn_packets(unit, plan);
  std::vector<GatherResult> due, results;
  std::vector<GatherPhoton> due_photons, photons;
  const auto golden = make_golden(unit, plan);
  golden->load(maps[0], maps[1]);
  golden->process(in, due, due_photons);
  const auto clocked = make_rtl(unit, plan, options);
  clocked->load(maps[0], maps[1]);
  const uint64_t before = clocked->cycles();
  clocked->process(in, results, photons);
  expect_equal(results == due && photons == due_photons, unit_name<PhotonGatherer>, options);
  const uint64_t cycles = clocked->cycles() - before;
  return {in.size(), cycles,
          trip_counts(plan, in, due,
                      {lines_a_leaf(plan, maps[0], false), lines_a_leaf(plan, maps[1], true)}),
          clocked->counters(), mean_in_flight(*clocked, cycles)};
}

}  // namespace photonloom
