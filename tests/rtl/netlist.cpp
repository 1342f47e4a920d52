// SPDX-License-Identifier: Apache-2.0
// Netlist and CXXRTL models: they answer as golden does, what is wrong in a netlist is found, and
// what is missing is named. The unit is the reorder buffer at its smallest, a stream register.
#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <regex>
#include <string>

#include "golden/numeric/output_file.hpp"
#include "tests/catch.hpp"
#include "tests/command/run.hpp"
#include "verilator_tb/unit/backends.hpp"
#include "verilator_tb/unit/compare_units.hpp"

using namespace photonloom;

namespace {

Plan pass_through_plan() {
  Plan p;
  p.global = {.present = true, .photons = 1000, .r2_max = 100};
  p.reorder_key = ReorderKey::kNone;
  return p;
}

RunOptions options(ModelKind kind) {
  RunOptions o;
  o.kind = kind;
  o.work_dir = "cosim";
  o.stall_in = o.stall_out = StallPolicy::parse("bernoulli:0.5");
  return o;
}

// What the comparison says of 500 packets, and how many were equal.
std::string verdict(const RunOptions& o, uint64_t& compared) {
  const auto golden = make_golden_reorder_buffer(pass_through_plan());
  CompareContext context;
  context.unit = "reorder_buffer";
  context.backend = model_kind_name(o.kind);
  context.waveform = waveform_extension(o.kind);
  context.rerun = "bench";
  std::vector<GatherQuery> in(500);
  RoleRandom random(1, "netlist test");
  for (GatherQuery& q : in) {
    q.pixel = static_cast<uint32_t>(random.below(1u << pass_through_plan().pixel_bits()));
    for (uint32_t& x : q.position) x = static_cast<uint32_t>(random.below(1u << 16));
  }
  compared = 0;
  try {
    const auto unit = make_rtl_reorder_buffer(pass_through_plan(), o);
    const auto both = compare_units(pass_through_plan(), context, *golden, *unit);
    std::vector<GatherQuery> out;
    both->process(in, out);
    unit->finish();
    compared = both->compared();
  } catch (const std::exception& error) {
    return error.what();
  }
  return "";
}

std::string library(ModelKind kind) {
  ModelSource source;
  source.unit = "reorder_buffer";
  source.work_dir = "cosim";
  source.kind = kind;
  return build_model(pass_through_plan(), source);
}

}  // namespace

TEST_CASE("netlist and CXXRTL are golden too") {
  for (const ModelKind kind : {ModelKind::kNetlist, ModelKind::kCxxrtl}) {
    INFO(model_kind_name(kind));
    uint64_t compared = 0;
    CHECK(verdict(options(kind), compared) == "");
    CHECK(compared == 500);
  }
}

TEST_CASE("one wrong bit in one look-up table of a netlist fails the comparison") {
  const std::string right =
      read_file(std::filesystem::path(library(ModelKind::kNetlist)).parent_path() / "netlist.v");
  const test::Scratch scratch;
  RunOptions o = options(ModelKind::kNetlist);
  o.netlist = scratch / "netlist.v";
  uint64_t compared = 0;

  write_file(o.netlist, right);
  CHECK(verdict(o, compared) == "");
  CHECK(compared == 500);

  // The table that a bit of the position goes into; its first bit says what holds while its inputs
  // are 0.
  static const std::regex table(
      R"(LUT4 #\(\s*\.INIT\(16'h([0-9a-f]{4})\)\s*\) [^;]*\(in_i ?\[30\][^;]*;)");
  std::smatch m;
  REQUIRE(std::regex_search(right, m, table));
  std::string wrong = right;
  const auto last = static_cast<size_t>(m.position(1)) + 3;
  const int digit = std::stoi(wrong.substr(last, 1), nullptr, 16) ^ 1;
  wrong.replace(last, 1, fmt::format("{:x}", digit));
  write_file(o.netlist, wrong);
  const std::string said = verdict(o, compared);
  CHECK_THAT(said, ContainsSubstring("differs from golden") && ContainsSubstring("\n  netlist 0x"));
}

TEST_CASE("a CXXRTL model writes its waveform as VCD") {
  RunOptions o = options(ModelKind::kCxxrtl);
  o.waveform = "netlist_test.vcd";
  o.waveform_from = 10;
  o.waveform_to = 60;
  std::filesystem::remove(o.waveform);
  uint64_t compared = 0;
  CHECK(verdict(o, compared) == "");
  const std::string text = read_file(o.waveform);
  CHECK_THAT(text, ContainsSubstring("$timescale") && ContainsSubstring("in_valid_i") &&
                       ContainsSubstring("\n#20\n") && ContainsSubstring("\n#121\n"));
  CHECK_THAT(text, !ContainsSubstring("\n#122\n"));
}

TEST_CASE("what is missing is named") {
  uint64_t compared = 0;
  for (const ModelKind kind : {ModelKind::kNetlist, ModelKind::kCxxrtl}) {
    RunOptions o = options(kind);
    o.yosys = "no-such-yosys";
    CHECK(verdict(o, compared) == "--yosys no-such-yosys: does not start or is no Yosys");
  }
  RunOptions o = options(ModelKind::kNetlist);
  o.netlist = "no-such-netlist.v";
  CHECK_THAT(verdict(o, compared), ContainsSubstring("no-such-netlist.v: "));
  const test::Scratch scratch;
  o.netlist = scratch / "other.v";
  write_file(o.netlist, "module other (input clk_i);\nendmodule\n");
  CHECK_THAT(verdict(o, compared), ContainsSubstring("verilator on reorder_buffer"));
}
