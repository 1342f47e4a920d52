// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "golden/numeric/memory.hpp"
#include "golden/transport/beam.hpp"
#include "golden/transport/bsdf.hpp"
#include "golden/transport/caustic_emission.hpp"
#include "golden/transport/intersect.hpp"
#include "golden/transport/roulette.hpp"
#include "golden/transport/visibility.hpp"

namespace photonloom {
namespace {

// Numbers of one photon's bounce n >= 1: dimension by purpose.
enum PhotonDimension : uint64_t {
  kPhotonLobe,
  kPhotonDirectionU,
  kPhotonDirectionV,
  kPhotonRoulette,
  kPhotonPart,
  kPhotonOpening
};

struct Walk {
  const World& world;
  const RayCaster& caster;
  Random random;
  int max_segments;  // -1: no limit
  bool caustic;      // stop at the first surface that is not delta
};

// Chooses a lobe and a direction; false: absorbed. Multiplies the power.
bool scatter(const Walk& walk, const Surface& s, uint64_t bounce, Vec3& out, Rgb& power) {
  const Random& r = walk.random;
  if (s.is_delta()) {
    Rgb weight;
    double ior2;
    if (!sample_delta(s, r.unit(bounce, kPhotonLobe), Carried::kPower, out, weight, ior2))
      return false;
    power *= weight;
    return true;
  }
  return leave_with_power(
      s, r.unit(bounce, kPhotonLobe),
      Vec2(r.unit(bounce, kPhotonDirectionU), r.unit(bounce, kPhotonDirectionV)), out, power);
}

// A photon's way from its emitter on.
void trace_path(const Walk& walk, uint64_t path, int rr_depth, const Emission& e, bool beam,
                std::vector<Photon>& photons) {
  Ray ray = e.ray;
  bool on_its_way = beam;  // its light starts where it lands
  Hit hit = first_surface(walk.world, walk.caster, e);
  Rgb throughput(1);
  double flight = 0;
  bool scattered = false;  // by a surface that is not a delta one
  bool by_delta = false;   // met one since the light
  for (uint64_t segment = 1; hit.valid(); ++segment) {
    const bool chooses = walk.world.has_choices();
    Surface s;
    // Open surfaces get all light that arrives, for what is opaque of them asks with its share.
    for (uint64_t i = 0;; ++i) {
      s = make_surface(walk.world, hit, ray.direction,
                       chooses ? walk.random.unit(segment, kPhotonPart) : 0);
      if (s.stores && !on_its_way && (!walk.caustic || by_delta))
        photons.push_back({hit.position, s.in,
                           e.power * throughput * (s.shading_ratio(s.in) * s.entering), path,
                           static_cast<uint32_t>(segment - 1), scattered ? flight : 0.0});
      const double opacity = walk.world.opacity(hit, ray.direction);
      if (opacity >= 1 || opening_number(walk.random.unit(segment, kPhotonOpening), i) < opacity)
        break;
      hit = walk.caster.closest(Ray{hit.position, ray.direction}, &hit);
      if (!hit.valid()) return;
      flight += hit.distance;
    }
    if (s.black()) return;
    const bool lands = on_its_way && !s.is_delta();
    if (walk.caustic && !s.is_delta() && !lands) return;
    by_delta = !lands && (by_delta || s.is_delta());
    on_its_way = on_its_way && !lands;
    if (walk.max_segments >= 0 && segment >= static_cast<uint64_t>(walk.max_segments)) return;
    if (!scatter(walk, s, segment, ray.direction, throughput)) return;
    if (!survives(throughput, segment, rr_depth, walk.random.unit(segment, kPhotonRoulette)))
      return;
    if (!s.is_delta() && !lands) {
      scattered = true;
      flight = 0;
    }
    hit = walk.caster.closest(Ray{hit.position, ray.direction}, &hit);
    flight += hit.distance;
  }
}

constexpr uint64_t kLeastBlock = 16;  // paths a task traces, at least and at most
constexpr uint64_t kGreatestBlock = 1024;
constexpr uint64_t kBlocksPerRound = 64;    // traced before their photons are counted
constexpr uint64_t kPathsPerCheck = 65536;  // traced before those that were cast are
constexpr uint64_t kPathsPerPhoton = 100;   // a map still short after this many is used as it is
constexpr uint64_t kCastPerPhoton = 32;     // the same for a caustic one, of paths towards a caster

PhotonPass traced(const World& world, const RayCaster& caster, uint64_t stored, uint64_t seed,
                  Progress* progress, bool caustic) {
  PhotonPass pass;
  const int depth = world.scene().max_depth;
  const int taken = caustic ? 1 : 2;  // segments from the camera to where the photons are asked for
  const int fewest = caustic ? 2 : 1;
  if (stored == 0 || (depth >= 0 && depth < taken + fewest)) return pass;
  const int max_segments = depth < 0 ? -1 : depth - taken;
  if (caustic && !world.has_delta()) return pass;
  const DeltaBoxes boxes(world);
  const CausticEmission emission(world, boxes);
  const Phase phase = caustic ? Phase::kCausticPhoton : Phase::kGlobalPhoton;
  const ProgressPhase progress_phase(progress, caustic ? "caustic photons" : "global photons",
                                     stored, "photons");
  const uint64_t limit = kPathsPerPhoton * stored;
  const uint64_t most_cast = caustic ? kCastPerPhoton * stored : limit;
  uint64_t cast = 0;
  std::vector<std::vector<Photon>> blocks(kBlocksPerRound);
  std::vector<uint64_t> cast_of(kBlocksPerRound);
  for (uint64_t first = 0; first < limit && pass.photons.size() < stored; first = pass.paths) {
    if (first % kPathsPerCheck == 0 && cast >= most_cast) break;
    // Few photons are asked for: a round of as many paths as they take, by those before, and some.
    const double needed = static_cast<double>(stored - pass.photons.size()) *
                          static_cast<double>(first + 1) /
                          static_cast<double>(pass.photons.size() + 1);
    const auto block = static_cast<uint64_t>(
        std::clamp<double>(needed / kBlocksPerRound + 1, kLeastBlock, kGreatestBlock));
    const uint64_t round_end = std::min(
        {first + block * kBlocksPerRound, limit, first - first % kPathsPerCheck + kPathsPerCheck});
    tbb::parallel_for(uint64_t{0}, kBlocksPerRound, [&](uint64_t b) {
      blocks[b].clear();
      cast_of[b] = 0;
      const uint64_t begin = std::min(first + b * block, round_end),
                     end = std::min(begin + block, round_end);
      for (uint64_t i = begin; i < end; ++i) {
        const Walk walk{world, caster, Random(seed, phase, i), max_segments, caustic};
        uint32_t emitter;
        const Emission e = caustic ? emission.emit(walk.random, emitter)
                                   : emit_photon(world, walk.random, emitter);
        if (is_black(e.power)) continue;  // a texture or an environment may be black in places
        const bool beam = is_beam(world, emitter);
        if (caustic && !beam && !boxes.met_by(e.ray)) continue;
        ++cast_of[b];
        trace_path(walk, i, world.scene().rr_depth, e, beam, blocks[b]);
      }
    });
    cast = std::accumulate(cast_of.begin(), cast_of.end(), cast);
    const size_t before = pass.photons.size();
    pass.paths = round_end;
    for (const auto& block : blocks)
      pass.photons.insert(pass.photons.end(), block.begin(), block.end());
    progress_phase.advance(std::min<size_t>(pass.photons.size(), stored) - before);
  }
  if (pass.photons.size() >= stored) {
    // Photons stand in the order of paths; the one that fills the map is kept whole.
    const uint64_t last = pass.photons[stored - 1].path;
    size_t end = stored;
    while (end < pass.photons.size() && pass.photons[end].path == last) ++end;
    pass.photons.resize(end);
    pass.paths = last + 1;
  }
  pass.short_of_request = pass.photons.size() < stored;
  for (Photon& p : pass.photons) p.power /= static_cast<double>(pass.paths);
  return pass;
}

PhotonPass trace(const World& world, const RayCaster& caster, uint64_t stored, uint64_t seed,
                 Progress* progress, bool caustic) {
  return with_memory_for(fmt::format("{} {} photons", stored, caustic ? "caustic" : "global"),
                         [&] { return traced(world, caster, stored, seed, progress, caustic); });
}

}  // namespace

PhotonPass trace_global_photons(const World& world, const RayCaster& caster, uint64_t stored,
                                uint64_t seed, Progress* progress) {
  return trace(world, caster, stored, seed, progress, false);
}

PhotonPass trace_caustic_photons(const World& world, const RayCaster& caster, uint64_t stored,
                                 uint64_t seed, Progress* progress) {
  return trace(world, caster, stored, seed, progress, true);
}

}  // namespace photonloom
