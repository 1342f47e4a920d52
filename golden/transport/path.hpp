// SPDX-License-Identifier: Apache-2.0
// The unbiased reference: a path tracer with multiple importance sampling that writes the photon
// mapper's layers.
#pragma once
#include <cstdint>

#include "golden/image/image.hpp"
#include "golden/numeric/progress.hpp"
#include "golden/transport/world.hpp"

namespace photonloom {

struct PathOptions {
  int spp = 16;
  uint64_t seed = 1;
  bool bidirectional = false;  // by bidirectional.hpp, a check of the other; several times slower
  Progress* progress = nullptr;
};

// The image of the scene's film. Channels: R, G, B; direct (light by shadow ray and its MIS partner
// at the first non-delta hit), caustic (diffuse lobe at the first non-delta hit, then only delta
// surfaces, then an emitter), emission (emitters seen directly or through delta surfaces), indirect
// (the rest); albedo, N, Z of the first hit; error (standard error of the pixel's mean). R, G, B
// are the sum of the four layers. Uses threads by tiles; the bytes do not depend on them.
Image render_path(const World& world, const RayCaster& caster, const PathOptions& options);

}  // namespace photonloom
