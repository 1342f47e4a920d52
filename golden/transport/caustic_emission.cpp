// SPDX-License-Identifier: Apache-2.0
#include "golden/transport/caustic_emission.hpp"

#include <algorithm>

#include "golden/numeric/elementary.hpp"

namespace photonloom {

CausticEmission::CausticEmission(const World& world, const DeltaBoxes& boxes)
    : world_(world), boxes_(boxes) {
  bool any = false;
  double sum = 0;
  for (uint32_t i = 0; i < world.emitters().size(); ++i) {
    any = any || is_aimed(i);
    cdf_.push_back(sum += mean(world.emitters()[i].power) * share(i));
  }
  if (!any) cdf_.clear();
}

double CausticEmission::share(uint32_t emitter) const {
  if (!is_aimed(emitter)) return 1;
  const Light& light = world_.scene().lights[static_cast<size_t>(world_.emitters()[emitter].light)];
  return (light.kind == LightKind::kDirectional ? boxes_.area_across(light.direction)
                                                : boxes_.mean_area_across()) /
         (kPi * world_.radius() * world_.radius());
}

bool CausticEmission::is_aimed(uint32_t emitter) const {
  const int32_t light = world_.emitters()[emitter].light;
  if (light < 0) return false;
  const LightKind kind = world_.scene().lights[static_cast<size_t>(light)].kind;
  return kind == LightKind::kDirectional || kind == LightKind::kEnvironment;
}

Emission CausticEmission::emit(const Random& random, uint32_t& emitter) const {
  if (cdf_.empty()) return emit_photon(world_, random, emitter);
  const auto at = std::upper_bound(cdf_.begin(), cdf_.end(), random.unit(0, 0) * cdf_.back());
  const size_t chosen = std::min(static_cast<size_t>(at - cdf_.begin()), cdf_.size() - 1);
  emitter = static_cast<uint32_t>(chosen);
  Emission out = from(emitter, random);
  out.power *= cdf_.back() / (cdf_[chosen] - (chosen > 0 ? cdf_[chosen - 1] : 0));
  return out;
}

Emission CausticEmission::from(uint32_t emitter, const Random& random) const {
  if (!is_aimed(emitter)) return emit_photon_from(world_, emitter, random);
  const Light& light = world_.scene().lights[static_cast<size_t>(world_.emitters()[emitter].light)];
  Vec3 direction = light.direction;
  Rgb irradiance = light.intensity;
  if (light.kind == LightKind::kEnvironment) {
    double pdf;
    direction = -world_.environment()->sample(Vec2(random.unit(0, 1), random.unit(0, 2)), pdf);
    irradiance = pdf > 0 ? world_.environment()->radiance(-direction) / pdf : Rgb(0);
  }
  double density;
  Emission out;
  out.ray =
      boxes_.aim(direction, random.unit(0, 5), Vec2(random.unit(0, 3), random.unit(0, 4)), density);
  out.power = irradiance / density;
  return out;
}

}  // namespace photonloom
