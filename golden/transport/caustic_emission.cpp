// SPDX-License-Identifier: Apache-2.0
#include "golden/transport/caustic_emission.hpp"

#include <algorithm>

#include "golden/numeric/elementary.hpp"

namespace photonloom {

CausticEmission::CausticEmission(const World& world, const DeltaBoxes& boxes)
    : world_(world), boxes_(boxes) {
  const double disk = kPi * world.radius() * world.radius();
  bool any = false;
  double sum = 0;
  for (uint32_t i = 0; i < world.emitters().size(); ++i) {
    const Emitter& e = world.emitters()[i];
    double share = 1;
    if (is_aimed(i)) {
      any = true;
      const Light& light = world.scene().lights[static_cast<size_t>(e.light)];
      share = (light.kind == LightKind::kDirectional ? boxes.area_across(light.direction)
                                                     : boxes.mean_area_across()) /
              disk;
    }
    cdf_.push_back(sum += mean(e.power) * share);
  }
  if (!any) cdf_.clear();
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
  Emission out =
      is_aimed(emitter) ? aimed(emitter, random) : emit_photon_from(world_, emitter, random);
  out.power *= cdf_.back() / (cdf_[chosen] - (chosen > 0 ? cdf_[chosen - 1] : 0));
  return out;
}

Emission CausticEmission::aimed(uint32_t emitter, const Random& random) const {
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
