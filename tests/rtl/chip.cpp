// SPDX-License-Identifier: Apache-2.0
// The generated top: its units wired as they are in a frame, fed through the chip's own ports, the
// links between its units as short as they are. What comes out is what golden units give one after
// the other.
#include <filesystem>
#include <optional>

#include "golden/unit/photon_gatherer.hpp"
#include "golden/unit/photon_gatherer_image.hpp"
#include "golden/unit/photon_lines.hpp"
#include "hls_kernels/generate/recording.hpp"
#include "rtl/generate/hardware.hpp"
#include "tests/catch.hpp"
#include "tests/command/run.hpp"
#include "verilator_tb/rig/stall.hpp"
#include "verilator_tb/unit/clocked_unit.hpp"

using namespace photonloom;

namespace {

Plan chip_plan() {
  Plan plan;
  plan.position_bits = 10;
  plan.global = {.present = true, .photons = 500};
  plan.caustic = {.present = true, .photons = 100};
  for (MapPlan* m : {&plan.global, &plan.caustic}) m->r2_max = plan.r2_limit();
  plan.k = 6;
  plan.gather_rays = 5;
  plan.contexts = 4;
  plan.cache_bytes = 1024;
  plan.reorder_packets = 50;
  plan.reorder_bins = 64;
  return plan;
}

std::vector<PackedPhoton> random_photons(const Plan& plan, uint64_t count, RoleRandom& random) {
  std::vector<PackedPhoton> photons(count);
  for (PackedPhoton& p : photons) {
    for (uint32_t& x : p.position)
      x = static_cast<uint32_t>(random.below(1u << plan.position_bits));
    for (int c = 0; c < plan.channels; ++c)
      p.power.mantissa[static_cast<size_t>(c)] = static_cast<uint32_t>(256 + random.below(256));
    p.direction = {static_cast<uint32_t>(random.below(256)),
                   static_cast<uint32_t>(random.below(256))};
  }
  return photons;
}

// Two batches: camera queries of both kinds, then final gathers, then a flush; in the second batch
// a camera query after the first final gather, which must then be reordered with the others.
std::vector<GatherQuery> batches(const Plan& plan, RoleRandom& random) {
  std::vector<GatherQuery> list;
  const auto query = [&](bool camera, bool caustic) {
    GatherQuery q{};
    q.pixel = static_cast<uint32_t>(list.size());
    q.tag = camera ? static_cast<uint32_t>(plan.gather_rays)
                   : static_cast<uint32_t>(random.below(static_cast<uint64_t>(plan.gather_rays)));
    q.map = caustic;
    q.want_photons = camera && !caustic;
    for (uint32_t& x : q.position)
      x = static_cast<uint32_t>(random.below(1u << plan.position_bits));
    q.normal = {static_cast<uint32_t>(random.below(256)), static_cast<uint32_t>(random.below(256))};
    list.push_back(q);
  };
  for (const bool second : {false, true}) {
    for (int i = 0; i < 40; ++i) query(true, i % 2 != 0);
    for (int i = 0; i < 130; ++i) query(second && i == 50, false);
    GatherQuery flush{};
    flush.flush = 1;
    list.push_back(flush);
  }
  return list;
}

struct Expected {
  std::vector<GatherResult> results;
  std::vector<GatherPhoton> photons;
};

// What the chip's header says: runs of final gathers up to their flush go through the buffer.
Expected golden(const Plan& plan, const PhotonMap& global, const PhotonMap& caustic,
                const std::vector<GatherQuery>& in) {
  const auto gatherer = make_golden_photon_gatherer(plan);
  const auto reorder = make_golden_reorder_buffer(plan);
  gatherer->load(global, caustic);
  std::vector<GatherQuery> order;
  bool run = false;
  for (const GatherQuery& q : in) {
    run |= q.flush || q.tag != static_cast<uint32_t>(plan.gather_rays);
    if (run && plan.reorder_key != ReorderKey::kNone)
      reorder->process({&q, 1}, order);
    else
      order.push_back(q);
    if (q.flush) run = false;
  }
  Expected e;
  gatherer->process(order, e.results, e.photons);
  return e;
}

void check_chip(const Plan& plan, const std::string& stall) {
  const uint64_t seed = 11;
  INFO("stall " << stall << ", seed " << seed);
  const test::Scratch package;
  for (const auto& [name, text] : generate_hardware({plan, {}, "", ""})) {
    std::filesystem::create_directories((package.path / name).parent_path());
    write_file(package / name, text);
  }
  RunOptions options;
  options.seed = seed;
  options.rtl_dir = package / "rtl";
  options.work_dir = "cosim";
  options.stall_in = options.stall_out = options.stall_memory = StallPolicy::parse(stall);
  options.random_latency = true;
  Rig rig(plan, "photonloom_chip", options);
  PacketSource<GatherQuery> queries(rig, plan, "query");
  PacketTaker<GatherResult> results(rig, plan, "result");
  PacketTaker<GatherPhoton> photons(rig, plan, "photon");
  PacketSource<SamplerInput> sampler_in(rig, plan, "sampler_in");
  PacketTaker<Sample> sampler_out(rig, plan, "sampler_out");
  std::optional<PacketSource<CacheLookup>> cache_in;
  std::optional<PacketTaker<CacheResult>> cache_out;
  std::vector<CacheLookup> lookups;
  std::vector<CacheResult> answers;
  if (plan.cache_present) {
    cache_in.emplace(rig, plan, "cache_in");
    cache_out.emplace(rig, plan, "cache_out");
    lookups = drawn_packets(std::type_identity<IrradianceCache>{}, plan);
    make_golden_irradiance_cache(plan)->process(lookups, answers);
  }
  LineMemory& memory = rig.add_memory(plan);
  rig.reset();

  RoleRandom random(seed, "chip");
  const PhotonMap global = build_photon_map(random_photons(plan, 500, random), plan);
  const PhotonMap caustic = build_photon_map(random_photons(plan, 100, random), plan);
  if (plan.compressed()) {
    REQUIRE_FALSE(further_lines(plan, global, false).empty());
    REQUIRE_FALSE(further_lines(plan, caustic, true).empty());
  }
  const PhotonGathererImage image = photon_gatherer_image(plan, global, caustic);
  for (const CfgWrite& w : image.cfg) {
    rig.set("cfg_valid_i", 1);
    rig.set("cfg_addr_i", w.address);
    rig.set("cfg_data_i", w.data);
    rig.cycle();
  }
  rig.set("cfg_valid_i", 0);
  memory.load(image.lines);

  const std::vector<GatherQuery> in = batches(plan, random);
  for (const GatherQuery& q : in) queries.push(q);
  std::vector<SamplerInput> tables;
  for (uint32_t t = 0; t < 20; ++t)
    for (int i = 0; i < 10; ++i) {
      SamplerInput p{};
      p.kind = i == 0 ? 0 : i < 6 ? 1 : 2;
      if (p.kind == 0) {
        p.pixel = t;
        p.normal = {100, 30};
      } else if (p.kind == 1) {
        p.mantissa = {300, 300, 300};
        p.exponent = t % 4;
        p.direction = {t * 9 % 256, 77};
      } else {
        p.tag = t % 5;
        p.u = random.bits() >> 32;
        p.v = {3, 4};
      }
      tables.push_back(p);
    }
  for (const SamplerInput& p : tables) sampler_in.push(p);
  for (const CacheLookup& p : lookups) cache_in->push(p);
  const Expected expected = golden(plan, global, caustic, in);
  std::vector<Sample> directions;
  make_golden_cdf_sampler(plan)->process(tables, directions);

  rig.run_until([&] {
    return results.stream().taken() >= expected.results.size() &&
           photons.stream().taken() >= expected.photons.size() &&
           sampler_out.stream().taken() >= directions.size() &&
           (!cache_out || cache_out->stream().taken() >= answers.size());
  });
  for (int i = 0; i < 500; ++i) rig.cycle();
  std::vector<uint64_t> cycles;
  Expected got;
  std::vector<Sample> samples;
  while (results.waiting()) got.results.push_back(results.pop(cycles));
  while (photons.waiting()) got.photons.push_back(photons.pop(cycles));
  while (sampler_out.waiting()) samples.push_back(sampler_out.pop(cycles));
  std::vector<CacheResult> answered;
  while (cache_out && cache_out->waiting()) answered.push_back(cache_out->pop(cycles));
  CHECK(got.results.size() == in.size());
  CHECK((got.results == expected.results));
  CHECK((got.photons == expected.photons));
  CHECK((samples == directions));
  CHECK((answered == answers));
}

}  // namespace

TEST_CASE("the chip gives what its units give one after the other") {
  check_chip(chip_plan(), "none");
  check_chip(chip_plan(), "bernoulli:0.5");
}

TEST_CASE("the smallest chip has no deadlock", "[slow]") {
  Plan plan = chip_plan();
  plan.contexts = plan.lanes = plan.cache_misses = plan.cache_ways = 1;
  plan.cache_bytes = plan.line_bytes();
  plan.reorder_packets = plan.reorder_bins = 1;
  check_chip(plan, "adversary");
}

TEST_CASE("a chip without reordering", "[slow]") {
  Plan plan = chip_plan();
  plan.reorder_key = ReorderKey::kNone;
  check_chip(plan, "bursts");
}

TEST_CASE("a chip of widths, compressed lines, parity and all units") {
  Plan plan = chip_plan();
  plan.nodes_per_cycle = plan.candidates_per_cycle = plan.powers_per_cycle = 2;
  plan.photon_lines = PhotonLines::kCompressed;
  plan.bucket = 16;
  plan.photon_bytes = 9;
  plan.further_percent = 1500;
  plan.beat_bits = 8 * plan.line_bytes();
  plan.cache_bytes = 16 * plan.line_bytes();
  plan.parity = plan.cache_present = true;
  plan.cache_records = 60;
  check_chip(plan, "bernoulli:0.5");
}
