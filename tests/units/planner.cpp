// SPDX-License-Identifier: Apache-2.0
// What a derived plan's lines and their reasons say of each other.
#include "golden/planner/planner.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <tuple>

#include "golden/numeric/octahedral.hpp"
#include "golden/planner/plan_fit.hpp"
#include "tests/catch.hpp"
#include "tests/oracles/scenes.hpp"

using namespace photonloom;
using namespace photonloom::oracle;

namespace {

const World& small_room() {
  static const World world = [] {
    Scene s;
    const int white = add_diffuse(s, Rgb(0.7));
    add_room(s, white, Vec3(0), Vec3(1));
    add_quad(s, white, Vec3(0.35, 0.999, 0.35), Vec3(0.3, 0, 0), Vec3(0, 0, 0.3)).radiance =
        Rgb(10);
    return World(s);
  }();
  return world;
}

PlannedFrame planned(size_t photons, std::vector<std::string> set, int gather_rays = 16,
                     std::optional<double> format_error = {}) {
  PhotonPass pass;
  for (size_t i = 0; i < photons; ++i) {
    const double along = static_cast<double>(i) / static_cast<double>(photons);
    // Two colours, so that the plan has three channels.
    const Rgb power(1 + static_cast<double>(i % 2), 1, 1);
    pass.photons.push_back({Vec3(0.1 + 0.8 * along, 0, 0.5), Vec3(0, 1, 0), power, i, 1});
  }
  pass.paths = photons;
  PlanRequest request;
  request.set = std::move(set);
  request.gather_rays = gather_rays;
  request.format_error = format_error;
  return make_plan(small_room(), request, pass, {});
}

uint64_t map_bytes(const Plan& p) {
  return p.memory_lines(p.global) * static_cast<uint64_t>(p.line_bytes());
}

}  // namespace

TEST_CASE("photons in a small part of the cube are warned of, whoever wrote its edge") {
  PhotonPass pass;
  for (uint64_t i = 0; i < 100; ++i)
    pass.photons.push_back({Vec3(0.01 * static_cast<double>(i)), Vec3(0, 1, 0), Rgb(1), i, 1});
  Plan plan = planned(100, {}).plan;
  CHECK(why_positions_are_coarse(plan, pass) == "");
  plan.position_bits = 20;
  plan.extent = 0x1p9;
  CHECK(why_positions_are_coarse(plan, pass) == "");
  plan.extent = 0x1p20;
  CHECK_THAT(
      why_positions_are_coarse(plan, pass),
      ContainsSubstring("within 2^-20 of scene.extent, too little for positions of 20 bits"));
  plan.position_bits = 24;
  plan.extent = 0x1p13;
  CHECK(why_positions_are_coarse(plan, pass) == "");
  // Each halving of the part takes a bit more; three too few are borne, four are not.
  plan.extent = 0x1p14;
  CHECK(why_positions_are_coarse(plan, pass) == "");
  plan.extent = 0x1p15;
  CHECK_THAT(
      why_positions_are_coarse(plan, pass),
      ContainsSubstring("within 2^-15 of scene.extent, too little for positions of 24 bits"));
  for (const size_t few : {2, 1, 0}) {
    pass.photons.resize(few, pass.photons[0]);
    CHECK(why_positions_are_coarse(plan, pass).empty() == (few < 2));
  }
}

TEST_CASE("directions have the fewest bits whose cells at the horizon carry less than the error") {
  // Light within an angle of the horizon is the square of its sine of all; the angle is the widest
  // cell's, from corner to corner.
  const auto carried = [](int bits) {
    const uint32_t cells = 1u << bits;
    double widest = 0;
    for (uint32_t u = 0; u + 1 < cells; ++u)
      for (uint32_t v = 0; v + 1 < cells; ++v) {
        const auto centre = [bits](uint32_t x, uint32_t y) {
          const IVec3 o = oct_decode({x, y}, bits);
          return glm::normalize(Vec3(o[0], o[1], o[2]));
        };
        for (const Vec3& across : {glm::cross(centre(u, v), centre(u + 1, v + 1)),
                                   glm::cross(centre(u + 1, v), centre(u, v + 1))})
          widest = std::max(widest, glm::dot(across, across));
      }
    return widest;
  };
  for (const int bits : {6, 7, 8, 9}) {
    CAPTURE(bits);
    const double error = std::ldexp(1.0, -bits);
    const int direction_bits = planned(100, {}, 16, error).plan.direction_bits;
    CHECK(carried(direction_bits) <= error);
    CHECK(carried(direction_bits - 1) > error);
  }
}

TEST_CASE("a batch has as many whole tiles as a million samples have room for") {
  constexpr uint64_t kMillion = uint64_t{1} << 20;
  const auto frame = [](int width, int height, int spp, int tile) {
    return planned(100,
                   {fmt::format("frame.width={}", width), fmt::format("frame.height={}", height),
                    fmt::format("frame.spp={}", spp), fmt::format("frame.tile={}", tile)})
        .plan.batch_tiles;
  };
  CHECK(frame(256, 256, 16, 16) == 0);  // just fit
  for (const auto& [width, height, spp, tile] :
       {std::tuple{256, 257, 16, 16}, {512, 512, 16, 16}, {512, 512, 5, 8}, {1025, 1024, 1, 16}}) {
    CAPTURE(width, height, spp, tile);
    const auto tiles = static_cast<uint64_t>(frame(width, height, spp, tile));
    const auto samples = static_cast<uint64_t>(tile * tile * spp);
    CHECK(tiles * samples <= kMillion);
    CHECK((tiles + 1) * samples > kMillion);
  }
}

TEST_CASE("one channel holds photons of its colour alone, in whichever channel they differ") {
  Plan plan;
  plan.channels = 1;
  plan.channel_color = {0.5, 1, 0.25};
  const Rgb colour(0.5, 1, 0.25);
  const auto holds_photon = [&](const Rgb& power) {
    return channels_hold(
        plan, {{Vec3(0), Vec3(0, 0, 1), colour, 0, 1}, {Vec3(0), Vec3(0, 0, 1), power, 1, 1}});
  };
  CHECK(holds_photon(colour * 3.0));
  CHECK(holds_photon(Rgb(0)));
  for (int channel = 0; channel < 3; ++channel) {
    Rgb other = colour * 3.0;
    other[channel] *= 0.75;
    CAPTURE(channel);
    CHECK_FALSE(holds_photon(other));
    plan.channels = 3;
    CHECK(holds_photon(other));
    plan.channels = 1;
  }
}

TEST_CASE("beats before an SDRAM are whole photons of any stride, 128 bits of them or more") {
  for (const auto& [bytes, beat] :
       {std::pair{12, 192}, {13, 208}, {16, 128}, {20, 160}, {24, 192}, {32, 256}}) {
    CAPTURE(bytes);
    const std::string stride = fmt::format("photon.photon_bytes={}", bytes);
    // More photons than block RAM serves.
    const Plan plan = planned(70000, {stride, "photon.bucket=16"}).plan;
    CHECK(plan.photon_memory == PhotonMemory::kSdram);
    CHECK(plan.beat_bits == beat);
    const Plan small = planned(100, {stride, "photon.bucket=16", "board.photon_memory=sdram"}).plan;
    CHECK(small.beat_bits == beat);
    CHECK(planned(40000, {stride, "photon.bucket=16", "board.photon_memory=block_ram"})
              .plan.beat_bits == 128);
  }
  // Without a leaf cache lanes take a beat a cycle.
  CHECK(planned(40000, {"photon.photon_bytes=12", "gatherer.cache_bytes=0", "gatherer.lanes=1"})
            .plan.beat_bits == 96);
}

TEST_CASE("maps that no board holds are planned for golden and the RTL alone") {
  // Lines of 16 bytes a photon, sixteen times as many as there are leaves.
  const auto of = [](size_t photons, const std::string& memory = "") {
    std::vector<std::string> set = {"photon.lines=compressed", "photon.photon_bytes=16",
                                    "photon.further_percent=1500"};
    if (!memory.empty()) set.push_back("board.photon_memory=" + memory);
    return planned(photons, std::move(set));
  };
  const PlannedFrame held = of(131072), beyond = of(131080);
  CHECK(map_bytes(held.plan) == Plan::kSdramBytes);
  CHECK(held.plan.photon_memory == PhotonMemory::kSdram);
  CHECK(beyond.plan.photon_memory == PhotonMemory::kBlockRam);
  CHECK(beyond.reasons.at("board.photon_memory") ==
        "the maps take 32770 KiB of an SDRAM, which has 32768: no board has room");
  CHECK_THROWS_WITH(of(131080, "sdram"),
                    ContainsSubstring("board.photon_memory is sdram, which holds 33554432 bytes; "
                                      "the maps' lines take 33556480"));
}

TEST_CASE("small maps lie in the leaf cache whole, whatever a line's bytes and the cache's ways") {
  for (const char* stride : {"12", "14", "16", "20", "32"})
    for (const char* ways : {"1", "2", "3"})
      for (const size_t photons : {10u, 1000u, 2040u}) {
        const PlannedFrame frame = planned(photons, {std::string("photon.photon_bytes=") + stride,
                                                     std::string("gatherer.cache_ways=") + ways});
        CAPTURE(stride, ways, photons);
        REQUIRE(map_bytes(frame.plan) <= 65536);
        CHECK(static_cast<uint64_t>(frame.plan.cache_bytes) >= map_bytes(frame.plan));
        CHECK_THAT(frame.reasons.at("gatherer.cache_bytes"), ContainsSubstring(" of the maps"));
        CHECK(frame.plan.reorder_key == ReorderKey::kNone);
      }
  CHECK(planned(1000, {}).plan.cache_bytes == 16384);
  // 60,000 bytes in ways of 192 bytes times a power of two.
  CHECK(planned(5000, {"photon.photon_bytes=12"}).plan.cache_bytes == 512 * 192);
}

TEST_CASE("a reason says that the leaf cache holds the maps only where both are there") {
  const PlannedFrame uncached = planned(8, {"gatherer.cache_bytes=0"});
  CHECK(uncached.plan.reorder_key == ReorderKey::kHilbert);
  CHECK_THAT(uncached.reasons.at("reorder.key"), !ContainsSubstring("leaf cache"));
  const PlannedFrame empty = planned(1000, {}, 0);
  REQUIRE_FALSE(empty.plan.global.present);
  CHECK_THAT(empty.reasons.at("gatherer.cache_bytes"), !ContainsSubstring("of the maps"));
}

TEST_CASE("reasons of the frame's order and of beats are true for the plan that has them") {
  const auto reason = [](const PlannedFrame& frame, const char* line) {
    return frame.reasons.at(line);
  };
  const std::string buffered = "the reorder buffer brings neighbours together; the frame need not";
  CHECK(reason(planned(40000, {}), "frame.order") == buffered);
  CHECK(reason(planned(1000, {}), "frame.order") ==
        "rays of a tile are made together; no reorder buffer follows");
  CHECK(reason(planned(40000, {"reorder.key=none"}), "frame.order") ==
        "rays of a tile are made together; no reorder buffer follows");
  CHECK(reason(planned(1000, {"reorder.key=hilbert"}), "frame.order") == buffered);
  CHECK(reason(planned(1000, {}, 0), "frame.order") ==
        "there are no final gather queries to order");
  CHECK(reason(planned(1000, {"frame.order=pixel"}), "frame.order") == "set by hand");

  CHECK(reason(planned(1000, {}), "gatherer.beat_bits") == "a 128-bit memory port");
  CHECK(reason(planned(40000, {"photon.photon_bytes=32"}), "gatherer.beat_bits") ==
        "whole photons of 32 bytes, as they come from an SDRAM");
  CHECK(reason(planned(1000, {"photon.lines=compressed"}), "gatherer.beat_bits") ==
        "a part of a line");
}
