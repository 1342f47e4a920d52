// SPDX-License-Identifier: Apache-2.0
// Faults of each kind, one kind at a time: how often the board tells of them, what they do to
// results, how long until it answers again. `make faults` makes docs/faults.md of what these cases
// report.
#include <fmt/core.h>

#include "tests/fault_report.hpp"
#include "tests/rtl/link_bench.hpp"
#include "verilator_tb/unit/backends.hpp"

using namespace photonloom;
using namespace photonloom::test;

namespace {

size_t any_place(const Bytes& wire, RoleRandom& random) { return random.below(wire.size()); }

struct Kind {
  const char* name;
  Harm harm;
};

constexpr Kind kKinds[] = {
    {"one bit flipped",
     [](Bytes wire, RoleRandom& random) {
       wire[any_place(wire, random)] ^= static_cast<uint8_t>(1u << random.below(8));
       return wire;
     }},
    {"byte changed",
     [](Bytes wire, RoleRandom& random) {
       wire[any_place(wire, random)] ^= static_cast<uint8_t>(1 + random.below(255));
       return wire;
     }},
    {"byte lost",
     [](Bytes wire, RoleRandom& random) {
       wire.erase(wire.begin() + static_cast<ptrdiff_t>(any_place(wire, random)));
       return wire;
     }},
    {"byte doubled",
     [](Bytes wire, RoleRandom& random) {
       const size_t at = any_place(wire, random);
       wire.insert(wire.begin() + static_cast<ptrdiff_t>(at), wire[at]);
       return wire;
     }},
    {"foreign byte",
     [](Bytes wire, RoleRandom& random) {
       wire.insert(wire.begin() + static_cast<ptrdiff_t>(any_place(wire, random)),
                   static_cast<uint8_t>(random.bits()));
       return wire;
     }},
    {"2 to 8 bytes cut out",
     [](Bytes wire, RoleRandom& random) {
       const size_t at = random.below(wire.size() - 1);
       const size_t last = std::min(wire.size(), at + 2 + random.below(7));
       wire.erase(wire.begin() + static_cast<ptrdiff_t>(at),
                  wire.begin() + static_cast<ptrdiff_t>(last));
       return wire;
     }},
    {"end of the frame cut off",
     [](Bytes wire, RoleRandom& random) {
       wire.resize(1 + random.below(wire.size() - 1));
       return wire;
     }},
};

// A WRITE harmed, a READ of the same register right behind it: cycles from the last byte of the
// first to the answer of the second.
void harm_writes(Bench& bench, const Kind& kind, int count) {
  INFO(kind.name);
  FaultRow row;
  row.fault = kind.name;
  row.where = "link, the board's side";
  RoleRandom random(7, kind.name);
  uint32_t session = 1;
  REQUIRE(bench.write(kSession, {session}) == 0);
  const uint32_t bad_before = bench.reg(13);
  uint64_t longest = 0;
  uint32_t bad = 0;
  for (int n = 0; n < count; ++n) {
    const auto id = static_cast<uint8_t>(2 * n);
    const auto probe = static_cast<uint8_t>(id + 1);
    const auto value = static_cast<uint32_t>(random.bits());
    Bytes body;
    append(body, kSession);
    append(body, value);
    bench.send(kind.harm(frame(id, kWrite, body), random));
    while (bench.board().wire().sending()) bench.run(1);
    const uint64_t from = bench.board().cycles();
    body.resize(4);
    body.push_back(1);
    bench.send(frame(probe, kRead, body));
    bool obeyed = false;
    for (;;) {
      const Answer answer = bench.next();
      if (answer.bad()) {
        ++bad;
        continue;
      }
      if (answer.id == probe && answer.command == (kRead | kAnswer)) {
        ++row.injected;
        obeyed ? ++row.harmless : ++row.detected;
        if (obeyed) session = value;
        row.wrong += answer.words() != Words{session};
        CHECK(answer.words() == Words{session});
        break;
      }
      REQUIRE(answer.id == id);
      REQUIRE(answer.command == (kWrite | kAnswer));
      REQUIRE(number(answer.body, 0) == 0);
      obeyed = true;
    }
    longest = std::max(longest, bench.board().cycles() - from);
  }
  CHECK(((bench.reg(13) - bad_before) & 0xffff) == bad);
  row.recovery = fmt::format("{} cycles at most until the next frame's answer is there", longest);
  report(row);
}

}  // namespace

TEST_CASE("faults: frames harmed, each kind alone") {
  Bench bench;
  for (const Kind& kind : kKinds) harm_writes(bench, kind, 400);
}

TEST_CASE("faults: frames harmed while queries go in and records come out") {
  for (const Kind& kind : kKinds) {
    INFO(kind.name);
    Bench bench;
    // Of its frames soak_on harms every second one.
    static uint64_t harmed;
    static Harm harm;
    harmed = 0;
    harm = kind.harm;
    const uint64_t refused = soak_on(bench, 3, 40, [](Bytes wire, RoleRandom& random) {
      ++harmed;
      return harm(std::move(wire), random);
    });
    CHECK(harmed > 10);
    CHECK(refused > 0);
  }
}

TEST_CASE("faults: the board reset while queries are inside") {
  FaultRow row;
  row.fault = "board reset";
  row.where = "board, queries inside";
  Bench bench;
  RoleRandom random(9, "reset");
  uint64_t longest = 0;
  for (uint64_t n = 0; n < 50; ++n) {
    bench.load(10 + n);
    REQUIRE(bench.write(kSession, {77}) == 0);
    const Words in = packed(bench.plan(), queries(bench.plan(), 12, n, true));
    bench.push(
        0, Words(in.begin(), in.begin() + static_cast<ptrdiff_t>(std::min<size_t>(64, in.size()))));
    bench.run(1 + random.below(3000));
    bench.reset_board();
    ++row.injected;
    const uint64_t from = bench.board().cycles();
    row.detected +=
        bench.reg(kSession) == 0;  // by which the host sees that all is to be given again
    longest = std::max(longest, bench.board().cycles() - from);
    // Maps, queries and records as if nothing had been.
    soak_on(bench, 20 + n, 12, [](Bytes wire, RoleRandom&) { return wire; });
  }
  CHECK(row.detected == row.injected);
  row.recovery = fmt::format("{} cycles at most to the first answer, then the maps again", longest);
  report(row);
}

TEST_CASE("faults: a line memory that is late and out of order") {
  Plan plan = small_plan();
  plan.gatherers = 1;
  FaultRow row;
  row.fault = "reply 1 to 8,000 cycles late, in any order";
  row.where = "memory port";
  RunOptions options;
  options.work_dir = "cosim";
  options.latency = 4000;
  options.random_latency = true;
  options.stall_memory = StallPolicy::parse("bursts");
  const PhotonMap global =
      build_photon_map(make_photons(plan, PointSet::kSurfaces, plan.global.photons, 1), plan);
  const PhotonMap caustic =
      build_photon_map(make_photons(plan, PointSet::kClustered, plan.caustic.photons, 2), plan);
  const auto golden = make_golden_photon_gatherer(plan);
  const auto rtl = make_rtl_photon_gatherer(plan, options);
  golden->load(global, caustic);
  rtl->load(global, caustic);
  std::vector<GatherResult> due, results;
  std::vector<GatherPhoton> due_photons, photons;
  const std::vector<GatherQuery> in = queries(plan, 200, 5, true);
  golden->process(in, due, due_photons);
  rtl->process(in, results, photons);
  rtl->finish();
  row.injected = rtl->counters().at("line requests");
  CHECK(row.injected > 50);
  row.harmless = row.injected;
  row.wrong = (results != due) + (photons != due_photons);
  CHECK(row.wrong == 0);
  row.recovery = "as long as the reply takes";
  report(row);
}
