// SPDX-License-Identifier: Apache-2.0
// The rig itself: it passes what is right and reports each way of being wrong. The unit here is a
// one-place buffer that misbehaves when a packet's `pixel` names a fault.
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "golden/numeric/output_file.hpp"
#include "golden/packet/layout.hpp"
#include "rtl/generate/sources.hpp"
#include "tests/catch.hpp"
#include "verilator_tb/rig/compare.hpp"
#include "verilator_tb/unit/backends.hpp"
#include "verilator_tb/unit/compare_units.hpp"

using namespace photonloom;

namespace {

enum Fault : uint32_t { kNone, kFlip, kDrop, kDouble, kWithdraw, kAlter, kStick, kAssert };

// What both units below have of a module's head.
const std::string kPorts = R"(// SPDX-License-Identifier: Apache-2.0
module reorder_buffer (
    input  logic clk_i,  // clock
    input  logic rst_i,  // reset
    input  logic in_valid_i,
    output logic in_ready_o,
    input  photonloom_pkg::gather_query_t in_i,  // packets
    output logic out_valid_o,
    input  logic out_ready_i,
    output photonloom_pkg::gather_query_t out_o)";

const std::string kUnit = kPorts + R"(,
    output logic [31:0] count_packets_o  // packets taken
);
  logic full_q, twice_q, seen_q;
  photonloom_pkg::gather_query_t packet_q;
  assign in_ready_o = !full_q;
  assign out_valid_o = full_q && packet_q.pixel != 6 && !(packet_q.pixel == 4 && seen_q);
  always_comb begin
    out_o = packet_q;
    if (packet_q.pixel == 1) out_o.position[20] = !packet_q.position[20];
    if (packet_q.pixel == 5 && seen_q) out_o.tag[0] = !packet_q.tag[0];
    if (packet_q.pixel == 7 && full_q) assert (rst_i);
  end
  always_ff @(posedge clk_i) begin
    seen_q <= out_valid_o && !out_ready_i;
    if (in_valid_i && in_ready_o) begin
      full_q <= in_i.pixel != 2;
      twice_q <= in_i.pixel == 3;
      packet_q <= in_i;
      count_packets_o <= count_packets_o + 1;
    end else if (out_valid_o && out_ready_i) begin
      full_q <= twice_q;
      twice_q <= 1'b0;
    end
    if (rst_i) begin
      full_q <= 1'b0;
      count_packets_o <= '0;
    end
  end
endmodule
)";

Plan plan() {
  Plan p;
  p.global = {true, 1000, 0, 0, 100};
  p.reorder_key = ReorderKey::kNone;
  return p;
}

RunOptions options(const std::string& stall) {
  static const std::string rtl = [] {
    const std::string dir = "rig_test_rtl";
    std::filesystem::create_directories(dir + "/reorder_buffer");
    write_file(dir + "/reorder_buffer/reorder_buffer.sv", kUnit);
    return dir;
  }();
  RunOptions o;
  o.rtl_dir = rtl;
  o.work_dir = "rig_test_work";
  o.stall_in = o.stall_out = StallPolicy::parse(stall);
  o.watchdog = 2000;
  return o;
}

// A unit that is a queue of four.
const std::string kQueue = kPorts + R"(
);
  fifo #(.Width($bits(in_i)), .Depth(4)) four (
      .clk_i(clk_i), .rst_i(rst_i), .in_valid_i(in_valid_i), .in_ready_o(in_ready_o), .in_i(in_i),
      .out_valid_o(out_valid_o), .out_ready_i(out_ready_i), .out_o(out_o)
  );
endmodule
)";

// How full the queue of four gets when its output stalls so.
std::vector<QueueFill> fills(const std::string& stall_out, bool watch) {
  const std::string dir = "rig_test_queue";
  for (const char* module : {"reorder_buffer", "common"})
    std::filesystem::create_directories(dir + "/" + module);
  write_file(dir + "/reorder_buffer/reorder_buffer.sv", kQueue);
  for (const std::string name : {"fifo", "lut_ram"})
    write_file(dir + "/common/" + name + ".sv",
               read_file(default_rtl_dir() + "/common/" + name + ".sv"));
  RunOptions o;
  o.rtl_dir = dir;
  o.work_dir = "rig_test_work";
  o.stall_out = StallPolicy::parse(stall_out);
  o.watch_queues = watch;
  Rig rig(plan(), "reorder_buffer", o);
  const int bits = PacketLayout::of<GatherQuery>(plan()).bits();
  Source& in = rig.add_source("in", bits);
  Taker& out = rig.add_taker("out", bits);
  rig.reset();
  const std::vector<uint32_t> packet(static_cast<size_t>(bits + 31) / 32, 5);
  for (int i = 0; i < 100; ++i) in.push(packet.data());
  rig.run_until([&] { return out.waiting() == 100; });
  return rig.queue_fills();
}

// Golden for this plan: the packets themselves.
class PassThrough final : public ReorderBuffer {
 public:
  void process(std::span<const GatherQuery> in, std::vector<GatherQuery>& out) override {
    out.insert(out.end(), in.begin(), in.end());
  }
  Counters counters() const override { return {}; }
};

std::vector<GatherQuery> packets(Fault fault, uint32_t at = 123) {
  std::vector<GatherQuery> list;
  for (uint32_t i = 0; i < 300; ++i) {
    GatherQuery q{};
    q.pixel = i == at ? static_cast<uint32_t>(fault) : 100u;
    q.sample = i % 16;
    q.position = {i, 2 * i, 40000 + i};
    list.push_back(q);
  }
  return list;
}

// What the rig says of a run; empty when all is well.
std::string verdict(Fault fault, const std::string& stall, uint32_t at = 123) {
  PassThrough golden;
  CompareContext context;
  context.unit = "reorder_buffer";
  context.rerun = "bench";
  try {
    const auto rtl = make_rtl_reorder_buffer(plan(), options(stall));
    const auto both = compare_units(plan(), context, golden, *rtl);
    std::vector<GatherQuery> out;
    both->process(packets(fault, at), out);
    rtl->finish();
    CHECK(both->compared() == 300);
    CHECK(rtl->counters().at("packets") == 300);
    CHECK((stall == "none") == (rtl->counters().at("stalls out") == 0));
  } catch (const RigError& error) {
    CHECK(error.cycle);  // so that a report's command has a window
    return error.what();
  } catch (const std::exception& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST_CASE("a right unit passes under every policy") {
  for (const char* stall : {"none", "bernoulli:0.5", "bursts", "adversary"}) {
    INFO("stall " << stall);
    CHECK(verdict(kNone, stall) == "");
  }
}

TEST_CASE("every way of being wrong is reported") {
  const std::string wrong = verdict(kFlip, "bernoulli:0.3");
  INFO(wrong);
  CHECK_THAT(wrong, ContainsSubstring("packet 123 differs from golden (123 matched before)"));
  CHECK_THAT(wrong, ContainsSubstring("\"position\": [123, 246, 40123]"));
  CHECK_THAT(wrong, ContainsSubstring("  * position[1]"));
  CHECK(std::count(wrong.begin(), wrong.end(), '*') == 1);
  CHECK_THAT(wrong, ContainsSubstring("position unit"));
  CHECK_THAT(wrong, ContainsSubstring("bench --wave reorder_buffer.fst --wave-unit reorder_buffer "
                                      "--wave-cycles "));
  CHECK_THAT(verdict(kDrop, "none"),
             ContainsSubstring("packet 123 differs") || ContainsSubstring("is stuck"));
  CHECK_THAT(verdict(kStick, "none"), ContainsSubstring("is stuck") &&
                                          ContainsSubstring("out: valid 0 ready 1") &&
                                          ContainsSubstring("in: valid 1 ready 0"));
  CHECK_THAT(verdict(kDouble, "none"),
             ContainsSubstring("packet 124 differs") || ContainsSubstring("one too many"));
  CHECK_THAT(verdict(kDouble, "none", 299),
             ContainsSubstring("is one too many: every packet owed had come out; it is "
                               "{\"pixel\": 3, "));
  CHECK_THAT(verdict(kWithdraw, "adversary"), ContainsSubstring("valid was withdrawn"));
  CHECK_THAT(verdict(kAlter, "adversary"), ContainsSubstring("the packet changed"));
  CHECK_THAT(verdict(kAssert, "none"), ContainsSubstring("unit reorder_buffer stopped in cycle ") &&
                                           ContainsSubstring("an assertion failed") &&
                                           ContainsSubstring(", 124 accepted, ") &&
                                           ContainsSubstring("out: valid "));
}

namespace {

// One query's answer of two photons, each stream with what is wrong in it and the cycles in which
// it came.
class Answering final : public ClockedPhotonGatherer {
 public:
  uint64_t wrong_flux = 0, flux_cycle = 0;
  uint32_t wrong_photon = 0;
  std::vector<uint64_t> photon_cycles = {20, 21};

  void load(const PhotonMap&, const PhotonMap&) override {}
  void process(std::span<const GatherQuery> in, std::vector<GatherResult>& results,
               std::vector<GatherPhoton>& photons) override {
    for (size_t i = 0; i < in.size(); ++i) {
      GatherResult r{};
      r.count = 2;
      r.flux[0] = wrong_flux;
      results.push_back(r);
      for (uint32_t p = 0; p < 2; ++p) {
        GatherPhoton photon{};
        photon.exponent = p == 1 ? wrong_photon : 0;
        photons.push_back(photon);
      }
    }
    result_cycles_ = {flux_cycle};
  }
  Counters counters() const override { return {}; }
  uint64_t cycles() const override { return 100; }
  std::span<const uint64_t> in_cycles() const override { return {}; }
  std::span<const uint64_t> out_cycles(int stream) const override {
    return stream == 0 ? result_cycles_ : photon_cycles;
  }
  void finish() override {}

 private:
  std::vector<uint64_t> result_cycles_;
};

}  // namespace

TEST_CASE("of two streams the packet that was wrong first is reported") {
  GatherQuery query{};
  query.want_photons = true;
  const auto said = [&](uint64_t flux_cycle, bool keep_going) {
    Answering golden, other;
    other.wrong_flux = 5;
    other.flux_cycle = flux_cycle;
    other.wrong_photon = 3;
    CompareContext context;
    context.unit = "photon_gatherer";
    context.keep_going = keep_going;
    const auto both = compare_units(plan(), context, golden, other);
    std::vector<GatherResult> results;
    std::vector<GatherPhoton> photons;
    try {
      both->process(std::span(&query, 1), results, photons);
    } catch (const Divergence& divergence) {
      return std::string(divergence.what());
    }
    CHECK(both->differences() == 2);
    return both->first_report();
  };
  for (const bool keep_going : {false, true}) {
    CHECK_THAT(said(22, keep_going), ContainsSubstring("stream photon: packet 1 differs"));
    CHECK_THAT(said(20, keep_going), ContainsSubstring("stream result: packet 0 differs"));
  }
}

TEST_CASE("a waveform holds the window that was asked for") {
  RunOptions o = options("none");
  o.waveform = "rig_test.fst";
  o.waveform_from = 50;
  o.waveform_to = 90;
  std::filesystem::remove(o.waveform);
  {
    const auto rtl = make_rtl_reorder_buffer(plan(), o);
    std::vector<GatherQuery> out;
    rtl->process(packets(kNone), out);
    CHECK(out == packets(kNone));
  }
  CHECK(std::filesystem::file_size(o.waveform) > 200);
}

TEST_CASE("initial register values follow their seed and cannot be seen") {
  for (uint64_t seed = 1; seed <= 3; ++seed) {
    RunOptions o = options("bernoulli:0.5");
    o.initial_seed = seed;
    const auto rtl = make_rtl_reorder_buffer(plan(), o);
    std::vector<GatherQuery> out;
    rtl->process(packets(kNone), out);
    CHECK(out == packets(kNone));
  }
}

TEST_CASE("how full a queue gets is counted where that is asked for") {
  CHECK(fills("none", false).empty());
  const std::vector<QueueFill> flowing = fills("none", true), held = fills("bernoulli:0.5", true);
  REQUIRE(flowing.size() == 1);
  REQUIRE(held.size() == 1);
  CHECK(flowing[0].name.ends_with(".four"));
  CHECK(flowing[0].depth == 4);
  CHECK(flowing[0].most == 1);
  CHECK(flowing[0].full == 0);
  CHECK(flowing[0].cycles > 100);
  CHECK(held[0].most == 4);
  CHECK(held[0].full > 10);
  CHECK(held[0].full < held[0].cycles);
  RunOptions o = options("none");
  o.kind = ModelKind::kCxxrtl;
  o.watch_queues = true;
  CHECK_THROWS_WITH(make_rtl_reorder_buffer(plan(), o),
                    ContainsSubstring("a model of kind cxxrtl has no open queues, expected rtl"));
}

TEST_CASE("a bad policy and RTL that does not elaborate are clear errors") {
  CHECK_THROWS_WITH(StallPolicy::parse("sometimes"),
                    "stall policy sometimes: expected none, bernoulli:P with P in [0, 1), bursts "
                    "or adversary");
  RunOptions o = options("none");
  o.rtl_dir = "rig_test_bad";
  std::filesystem::create_directories("rig_test_bad/reorder_buffer");
  std::string broken = kUnit;
  broken.replace(broken.find("!full_q;"), 8, "!ful_q;");
  write_file("rig_test_bad/reorder_buffer/reorder_buffer.sv", broken);
  CHECK_THROWS_WITH(make_rtl_reorder_buffer(plan(), o),
                    ContainsSubstring("verilator on reorder_buffer") && ContainsSubstring("ful_q"));
  // Verilator stops for warnings too; its last line counts them and names none.
  std::string careless = kUnit;
  const size_t at = careless.find("  assign in_ready_o");
  careless.insert(at, "  logic nobody_reads_it;\n  assign nobody_reads_it = full_q;\n");
  write_file("rig_test_bad/reorder_buffer/reorder_buffer.sv", careless);
  CHECK_THROWS_WITH(
      make_rtl_reorder_buffer(plan(), o),
      ContainsSubstring("verilator on reorder_buffer") && ContainsSubstring("nobody_reads_it"));
  o.rtl_dir = "rig_test_nowhere";
  CHECK_THROWS_WITH(make_rtl_reorder_buffer(plan(), o),
                    ContainsSubstring("is no folder, expected the RTL sources"));
}

TEST_CASE("a report's command shows its cycle, also where a waveform missed it") {
  CompareContext context;
  context.unit = "reorder_buffer";
  context.rerun = "bench";
  CHECK(again_text(context, 5000) ==
        "  again, with a waveform of the window around it:\n    bench --wave reorder_buffer.fst "
        "--wave-unit reorder_buffer --wave-cycles 4000:5050\n    gtkwave reorder_buffer.fst");
  RunOptions options;
  options.waveform = "a.fst";
  options.waveform_from = 4000;
  options.waveform_to = 5050;
  context.writes(options);
  for (const uint64_t cycle : {4000, 5050})
    CHECK(again_text(context, cycle) == "  in the waveform that is written:\n    gtkwave a.fst");
  for (const uint64_t cycle : {3999, 5051}) {
    const std::string text = again_text(context, cycle);
    CHECK(text.starts_with("  not in the waveform, which has cycles 4000 to 5050: "));
    CHECK(text.ends_with(" --wave-cycles " + std::to_string(cycle - 1000) + ":" +
                         std::to_string(cycle + 50) + "\n    gtkwave reorder_buffer.fst"));
  }
}

TEST_CASE("a counter that golden or the rig has and the hardware lacks is an error") {
  const Counters golden{{"queries", 7}, {"nodes", 9},   {"photons out", 3},
                        {"flushes", 1}, {"clamped", 0}, {"full", 2}};
  const Counters hardware{{"queries", 7},         {"nodes", 9},           {"stalls in", 4},
                          {"stalled in", 4},      {"stalls results", 3},  {"stalls photons", 2},
                          {"stalled results", 3}, {"stalled photons", 2}, {"busy", 50},
                          {"line requests", 6},   {"cache misses", 6}};
  CHECK_NOTHROW(check_counters("unit", golden, hardware, 100));
  for (const char* name :
       {"queries", "nodes", "stalled in", "stalled results", "stalled photons", "cache misses"}) {
    INFO(name);
    Counters fewer = hardware;
    fewer.erase(name);
    CHECK_THROWS_WITH(
        check_counters("unit", golden, fewer, 100),
        ContainsSubstring(std::string("unit unit: has no counter ") + name + ", which "));
    Counters wrong = hardware;
    ++wrong[name];
    CHECK_THROWS_WITH(check_counters("unit", golden, wrong, 100), ContainsSubstring("expected"));
  }
  CHECK_THROWS_WITH(check_counters("unit", golden, hardware, 49),
                    ContainsSubstring("counts 50 busy, expected no more than the 49 cycles"));
  // What golden alone counts of one unit it does not of another.
  CHECK_THROWS_WITH(check_counters("unit", {{"flushes", 1}}, {{"stalls in", 4}}, 100),
                    ContainsSubstring("has no counter flushes, which golden has"));
  // A kernel has no ports to count at.
  CHECK_NOTHROW(check_counters("unit", golden, {{"nodes", 9}}, 100));
}
