// SPDX-License-Identifier: Apache-2.0
// Modules of a board alone, for what takes too long, or cannot be brought about, at its wires.
#include <fmt/core.h>

#include <cstring>

#include "golden/numeric/random.hpp"
#include "golden/unit/self_test.hpp"
#include "tests/rtl/link_bench.hpp"

using namespace photonloom;
using namespace photonloom::test;

namespace {

// A module under its clock; all inputs are 0.
class Part {
 public:
  Part(const Plan& plan, const std::string& module, std::vector<std::string> parameters = {})
      : model_(build_model(plan, {.unit = module,
                                  .rtl_dir = {},
                                  .work_dir = "cosim",
                                  .parameters = std::move(parameters)}),
               1) {
    for (const ModelPort& p : model_.ports())
      if (!p.output) std::memset(p.data, 0, p.bytes);
    reset();
  }
  void set(const std::string& port, uint64_t value, size_t from_byte = 0) {
    const ModelPort& p = model_.port(port);
    std::memcpy(p.data + from_byte, &value, std::min<size_t>(p.bytes - from_byte, 8));
  }
  uint64_t get(const std::string& port) const {
    const ModelPort& p = model_.port(port);
    uint64_t value = 0;
    std::memcpy(&value, p.data, std::min<size_t>(p.bytes, 8));
    return value;
  }
  void settle() { model_.eval(); }
  void cycle() {
    set("clk_i", 0);
    settle();
    set("clk_i", 1);
    settle();
  }
  void reset() {
    set("rst_i", 1);
    for (int i = 0; i < 4; ++i) cycle();
    set("rst_i", 0);
  }

 private:
  Model model_;
};

}  // namespace

TEST_CASE("board parts: the self-test passes by its signature, and whatever hangs has failed") {
  Plan plan = small_plan();
  plan.self_test = true;
  const SelfTest test = make_self_test(plan);
  constexpr int kTimeoutBits = 16;
  Part part(plan, "self_test", {fmt::format("TimeoutBits={}", kTimeoutBits)});
  Words written;
  // Cycles until it is through.
  const auto run = [&] {
    part.reset();
    written.clear();
    part.settle();
    CHECK(part.get("passed_o") == 0);
    CHECK(part.get("failed_o") == 0);
    uint64_t cycles = 0;
    for (; part.get("running_o"); ++cycles) {
      if (part.get("write_valid_o") && part.get("write_ready_i"))
        written.push_back(static_cast<uint32_t>(part.get("write_word_o")));
      if (cycles > 2u << kTimeoutBits) break;  // it never is
      part.cycle();
    }
    return cycles;
  };
  const auto passed = [&] {
    CHECK(part.get("passed_o") + part.get("failed_o") == 1);
    return part.get("passed_o") == 1;
  };
  const auto all_well = [&] {
    part.set("memory_ready_i", 1);
    part.set("write_ready_i", 1);
    part.set("write_status_i", 0);
    part.set("replay_busy_i", 0);
    part.set("replay_signature_i", test.signature);
    part.set("replay_results_i", test.results);
  };

  all_well();
  CHECK(run() < 1u << kTimeoutBits);
  CHECK(passed());
  Words words;  // of the script, without its addresses and numbers of words
  for (size_t at = 0; at < test.words.size(); at += 2 + test.words[at + 1])
    for (size_t i = 0; i < test.words[at + 1]; ++i) words.push_back(test.words[at + 2 + i]);
  CHECK(written == words);
  part.set("replay_signature_i", test.signature ^ 1);
  CHECK(run() < 1u << kTimeoutBits);
  CHECK(!passed());

  const std::pair<const char*, uint64_t> hangs[] = {
      {"memory_ready_i", 0}, {"write_ready_i", 0}, {"replay_busy_i", 1}};
  for (const auto& [port, value] : hangs) {
    INFO(port << " stays " << value);
    all_well();
    part.set(port, value);
    const uint64_t cycles = run();
    CHECK(cycles <= 1u << kTimeoutBits);
    CHECK(cycles > (1u << kTimeoutBits) - 4);
    CHECK(!passed());
    // It stays so, whatever comes late.
    all_well();
    for (int i = 0; i < 100; ++i) part.cycle();
    CHECK(part.get("running_o") == 0);
    CHECK(!passed());
  }
}

TEST_CASE("board parts: a cold replay begins when caches can have forgotten all their sets") {
  Plan plan = small_plan();
  plan.cache_bytes = 16384;
  Part part(plan, "query_replayer");
  const auto sets = static_cast<uint64_t>(plan.cache_bytes / (plan.line_bytes() * plan.cache_ways));
  CHECK(sets == 128);
  part.set("queries_i", 1);
  part.set("passes_i", 1);
  part.set("query_ready_i", 1);
  for (const bool cold : {true, false, true}) {
    part.set("mode_i", cold ? 2 : 0);
    part.set("start_i", 1);
    part.cycle();
    part.set("start_i", 0);
    uint64_t forgets = 0, since = 0;  // cycles
    for (int i = 0; !part.get("query_valid_o"); ++i) {
      REQUIRE(i < 1000);
      if (part.get("forget_o")) {
        ++forgets;
        since = 0;
      }
      part.cycle();
      ++since;
    }
    CHECK(forgets == cold);
    if (cold)
      CHECK(since >= sets);  // caches forget a set a cycle
    else
      CHECK(since < 10);
    for (int i = 0; i < 20; ++i) part.cycle();
    CHECK(part.get("busy_o") == 0);
  }
}

TEST_CASE("board parts: counters are read with all their bits, lost bytes one by one") {
  Part part(small_plan(), "board_registers");
  part.set("first_i", 1);
  const auto read = [&](uint64_t address) {
    part.set("address_i", address);
    for (int i = 0; i < 4; ++i) part.cycle();
    return part.get("word_o");
  };
  // Of 40 bits each, the first lowest.
  uint64_t counters[12];
  for (uint64_t i = 0; i < 12; ++i) {
    counters[i] = hash_bits(5, i, 0, 0) % (uint64_t{1} << 40) | uint64_t{1} << 39;
    part.set("counters_i", counters[i], 5 * i);
  }
  for (uint64_t i = 0; i < 12; ++i) {
    INFO("counter " << i);
    CHECK(read(32 + 2 * i) == (counters[i] & 0xffffffff));
    CHECK(read(33 + 2 * i) == counters[i] >> 32);
  }
  // A counter that runs, read as a frame reads it: wrong only where its low word tells that it may
  // be.
  constexpr uint64_t kCarry = uint64_t{1} << 32;
  for (uint64_t from = kCarry - 24; from < kCarry + 8; ++from) {
    uint64_t count = from;
    const auto read_while_it_runs = [&](uint64_t address) {
      part.set("address_i", address);
      for (int i = 0; i < 4; ++i) {
        part.set("counters_i", count++);
        part.cycle();
      }
      return part.get("word_o");
    };
    part.set("first_i", 1);
    const uint64_t low = read_while_it_runs(32);
    part.set("first_i", 0);
    for (int i = 0; i < 40; ++i) read_while_it_runs(33);
    const uint64_t joined = read_while_it_runs(33) << 32 | low;
    const bool had_it = joined >= from && joined < from + 8;
    INFO("a counter from " << from << " on, read as " << joined);
    CHECK((had_it || low >= kCarry - 2));
  }
  part.set("first_i", 1);
  for (const uint64_t lost : {1, 7, 65536 - 9, 10}) {
    const uint64_t before = read(14);
    part.set("byte_lost_i", 1);
    for (uint64_t i = 0; i < lost; ++i) part.cycle();
    part.set("byte_lost_i", 0);
    CHECK(read(14) == (before + lost) % 65536);
  }
}

TEST_CASE(
    "board parts: a reset of any length holds both domains until each has had an edge in it") {
  Part part(small_plan(), "reset_bridge");
  RoleRandom random(4, "resets");
  INFO("seed 4");
  for (const double ratio : {0.21, 0.5, 1.0, 1.03, 2.7, 11.0}) {  // the other clock's period
    double until_edge = 0;
    for (int n = 0; n < 40; ++n) {
      const auto length = 1 + random.below(4);
      bool other_reset = false;
      uint64_t held = 0;
      for (uint64_t i = 0; i < 200; ++i) {
        part.set("rst_i", i < length);
        part.settle();
        INFO("ratio " << ratio << ", reset of " << length << ", cycle " << i);
        if (part.get("rst_o")) {
          REQUIRE(held == i);  // it does not come back
          ++held;
        } else {
          REQUIRE(i >= length);
          REQUIRE(other_reset);
          REQUIRE(part.get("other_rst_o") == 0);
        }
        for (until_edge -= 1; until_edge <= 0; until_edge += ratio) {
          other_reset |= part.get("other_rst_o") != 0;
          part.set("other_clk_i", 0);
          part.settle();
          part.set("other_clk_i", 1);
          part.settle();
        }
        part.cycle();
      }
      REQUIRE(held < 200);
    }
  }
}
