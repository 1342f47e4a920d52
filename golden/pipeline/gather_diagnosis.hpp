// SPDX-License-Identifier: Apache-2.0
// Why a region of a frame is dark or noisy: gathers that found no photon within the radius, or
// fewer than k, and whether that is for want of photons of one light; with the lines that would
// mend it. docs/frame.md has the rules.
#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "golden/pipeline/prepare.hpp"

namespace photonloom {

// Gathers of one photon map.
struct GatherTally {
  uint64_t gathers = 0;
  uint64_t none = 0;  // found no photon
  uint64_t few = 0;   // found some, but fewer than k
};

// Sees every gather of a frame's photon_gatherer, golden or not.
class GatherWatch {
 public:
  explicit GatherWatch(const Plan& plan);

  // The same unit, watched; it may outlive the watch.
  std::unique_ptr<PhotonGatherer> wrap(std::unique_ptr<PhotonGatherer> unit);

  // Of the global map, a pixel's.
  struct Pixel {
    GatherTally tally;
    uint64_t found = 0;  // photons, of all gathers
    // The first gather that found fewer than k; good where there is one.
    UVec3 position{};
    Pair32 normal{};
  };
  const GatherTally& tally(bool is_caustic) const;
  const std::vector<Pixel>& pixels() const;  // by pixel number

  struct Record;

 private:
  Plan plan_;
  std::shared_ptr<Record> record_;
};

enum class Shortage { kNoPhoton, kFewPhotons, kStarvedLight };
const char* shortage_name(Shortage shortage);

// Lines that put k photons within reach of three quarters of a region's gathers.
struct Advice {
  uint64_t photons = 0;  // of the global map, as --photons
  double radius = 0;     // as --set global.radius
  int k = 0;             // as --k
  std::string options;   // what differs from the plan, as a command line has it
};

// Pixels that are short of photons for one reason.
struct ShortRegion {
  Shortage shortage = Shortage::kNoPhoton;
  uint64_t pixels = 0;
  double found = 0;                         // photons a gather, mean
  std::string light;                        // of kStarvedLight: its name
  uint64_t light_photons = 0, photons = 0;  // of kStarvedLight: what the map holds of it and of all
  Advice advice;
  std::string message;  // a sentence with the figures, and what mends it
};

struct GatherDiagnosis {
  GatherTally tally[2];              // global, caustic
  std::vector<ShortRegion> regions;  // of at least kShortPart of the image, the largest first
  // By pixel: the part of its final gathers that found none, fewer than k, and fewer than k of a
  // starved light.
  std::vector<float> no_photon, few_photons, starved_light;

  // Adds the layers noPhoton, fewPhotons and starvedLight.
  void add_layers(Image& image) const;
};

// A pixel is short of photons where its gathers find less than this part of k: their noise is then
// twice what k promises.
inline constexpr double kShortOfK = 0.25;
// Part of the image from which a region is spoken of.
inline constexpr double kShortPart = 0.01;

// `seed` is that of the photons; nothing where they were loaded from a file, whose lights are not
// known.
GatherDiagnosis diagnose_gathers(const GatherWatch& watch, const PreparedFrame& frame,
                                 std::optional<uint64_t> seed);

}  // namespace photonloom
