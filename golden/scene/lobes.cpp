// SPDX-License-Identifier: Apache-2.0
#include "golden/scene/scene.hpp"

namespace photonloom {
namespace {

// Whether one of a BSDF's parts, or itself, has what `has` asks for.
template <class Has>
bool any_part(const Scene& scene, const Bsdf* b, Has&& has) {
  if (!b) return false;
  if (b->kind != BsdfKind::kMixture) return has(*b);
  for (const int part : b->parts)
    if (part >= 0 && any_part(scene, &scene.bsdfs[static_cast<size_t>(part)], has)) return true;
  return false;
}

}  // namespace

bool has_diffuse_part(const Scene& scene, const Bsdf* bsdf) {
  return any_part(scene, bsdf,
                  [](const Bsdf& b) { return !is_black(b.diffuse) && b.has_diffuse(); });
}

bool has_delta_part(const Scene& scene, const Bsdf* bsdf) {
  return any_part(scene, bsdf, [](const Bsdf& b) {
    return b.is_delta() || (b.kind == BsdfKind::kPlastic && !is_black(b.specular)) ||
           (b.is_coated() && !is_black(b.coat_specular));
  });
}

bool has_glossy_part(const Scene& scene, const Bsdf* bsdf) {
  return any_part(scene, bsdf, [](const Bsdf& b) {
    const bool rough = b.kind == BsdfKind::kRoughConductor || b.kind == BsdfKind::kRoughPlastic;
    return b.kind == BsdfKind::kRoughDielectric || b.kind == BsdfKind::kPrincipled ||
           (b.follow_diffuse && !is_black(b.diffuse)) ||
           ((rough || b.kind == BsdfKind::kPhong) && !is_black(b.specular));
  });
}

bool has_open_part(const Scene& scene, const Bsdf* bsdf) {
  const auto open = [](const Bsdf& b) { return b.opacity < 1 || b.textured(Slot::kOpacity) >= 0; };
  return bsdf && (open(*bsdf) || any_part(scene, bsdf, open));
}

std::vector<bool> used_bsdfs(const Scene& scene) {
  std::vector<bool> used(scene.bsdfs.size(), false);
  const auto use = [&](const auto& again, int index) -> void {
    if (index < 0 || used[static_cast<size_t>(index)]) return;
    used[static_cast<size_t>(index)] = true;
    for (const int part : scene.bsdfs[static_cast<size_t>(index)].parts) again(again, part);
  };
  for (const Shape& s : scene.shapes)
    for (const int side : {s.bsdf, s.back_bsdf}) use(use, side);
  return used;
}

}  // namespace photonloom
