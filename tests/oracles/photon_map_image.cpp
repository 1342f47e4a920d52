// SPDX-License-Identifier: Apache-2.0
// Whole photon-mapped images, golden units included, against closed forms.
#include <cmath>

#include "golden/pipeline/prepare.hpp"
#include "tests/catch.hpp"
#include "tests/oracles/scenes.hpp"
#include "tests/oracles/statistics.hpp"

using namespace photonloom;
using namespace photonloom::oracle;

namespace {

Image photon_map_image(const Scene& scene, const FrameRequest& request, Arithmetic arithmetic) {
  const PreparedFrame frame =
      prepare_frame(std::make_unique<World>(scene), request, arithmetic, nullptr);
  FrameUnits units = make_golden_units(frame.plan);
  FrameCounts counts;
  return render_frame(frame.input(arithmetic), units, counts);
}

// Each map has an error of its own, that of the number of paths that fill it, so the standard error
// is that of independent maps, those of all seeds together.
void check_furnace(double rho, uint64_t photons, uint64_t maps_per_seed) {
  for (bool sphere : {true, false}) {
    Scene s;
    s.name = "furnace";
    const int grey = add_diffuse(s, Rgb(rho));
    (sphere ? add_sphere(s, grey, Vec3(1, 2, 3), 2, true)
            : add_room(s, grey, Vec3(0), Vec3(1, 2, 3)))
        .radiance = Rgb(1);
    set_camera(s, sphere ? Vec3(1.5, 2, 3) : Vec3(0.3, 0.4, 0.5), Vec3(1, 1, 1), Vec3(0, 1, 0), 90,
               10, 10);
    Tally maps;
    for (uint64_t seed : kSeeds)
      for (uint64_t map = 0; map < maps_per_seed; ++map) {
        FrameRequest request;
        request.photons = photons;
        request.k = 50;
        request.spp = 16;
        request.gather_rays = 16;
        request.seed = batch_seed(seed, map);
        maps.add(channel_mean(photon_map_image(s, request, Arithmetic::kGolden), "G"));
      }
    check_estimate(sphere ? "sphere" : "box", 0, maps.estimate(), 1 / (1 - rho), 0.005);
  }
}

}  // namespace

TEST_CASE("white furnace by photon map: the image's mean is Le / (1 - rho) within 0.5 %") {
  check_furnace(0.5, 60000, 3);
}

TEST_CASE("white furnace by photon map: the same where nine tenths are reflected", "[slow]") {
  check_furnace(0.9, 160000, 18);
}
