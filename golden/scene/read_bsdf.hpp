// SPDX-License-Identifier: Apache-2.0
// What <bsdf> and <texture> elements mean. docs/scene.md lists them, docs/materials.md defines
// them.
#pragma once
#include <map>
#include <memory>
#include <string>
#include <tuple>

#include "golden/scene/findings.hpp"
#include "golden/scene/properties.hpp"
#include "golden/scene/scene.hpp"

namespace photonloom {

// What the two sides of a surface see; indices into Scene::bsdfs, -1: black.
struct Sides {
  int front = -1, back = -1;
};

class BsdfReader {
 public:
  BsdfReader(const Document& document, Scene& scene, Findings& findings)
      : document_(document), scene_(scene), findings_(findings) {}

  // An element is read once, however often it is referred to.
  Sides bsdf(const Element& e, int level = 0);
  int texture(const Element& e, int level = 0);  // index into Scene::textures
  // A bitmap of an element's property `filename`; the same file is held once.
  std::shared_ptr<const Bitmap> bitmap(Properties& p);
  // The value of a property that may be a texture; then `texture` is its index and the result 1.
  Rgb textured(Properties& p, const std::string& name, const Rgb& otherwise, int& texture,
               SpectrumOf of = SpectrumOf::kSurface);

  int add(const Bsdf& bsdf);
  // Some light goes straight on through one of the sides, or reaches the other one.
  bool lets_light_pass(int bsdf) const;
  // Some part of it lets light pass straight on.
  bool is_open(int bsdf) const;

 private:
  void warn(const Element& e, const std::string& what);
  Rgb value(Properties& p, Bsdf& b, Slot slot, const std::string& name, const Rgb& otherwise);
  double largest(const Bsdf& b, Slot slot, const Rgb& factor) const;
  void conserve(Properties& p, const Bsdf& b, Rgb& first, Slot slot, Rgb* second);
  double ior(Properties& p, const std::string& name, const std::string& otherwise);
  // Inside over outside; the medium inside is `otherwise` where none is given.
  double relative_ior(Properties& p, const std::string& otherwise);
  static double checked_ior(Properties& p, double relative);
  void roughness(Properties& p, Bsdf& b);
  void diffuse(Properties& p, Bsdf& b);
  void phong(Properties& p, Bsdf& b);
  void conductor(Properties& p, Bsdf& b);
  void dielectric(Properties& p, Bsdf& b);
  void plastic(Properties& p, Bsdf& b);
  void principled(Properties& p, Bsdf& b);
  Sides coating(Properties& p, int level);
  Sides two_sided(Properties& p, int level);
  Sides mask(Properties& p, int level);
  Sides mixture(Properties& p, int level);
  // Photons carry the light that enters a coat, and one map knows one coat, or none: that with the
  // largest share of a mixture's light, the first of equal ones. Diffuse lobes under others are
  // followed as paths.
  void keep_one_coat(Bsdf& mixture);
  int64_t leaves_of(int index) const;  // BSDFs that are no mixtures
  Sides normals(Properties& p, int level);
  // The one BSDF inside; what else stands there is named as not expected.
  Sides only_bsdf(Properties& p, int level, const char* expected);
  bool turns_normals(int index) const;
  Sides substitute(Properties& p, int level);
  Rgb color0or1(Properties& p, const char* name, const Rgb& otherwise);

  const Document& document_;
  Scene& scene_;
  Findings& findings_;
  std::map<const Element*, Sides> bsdfs_;
  std::map<const Element*, int> textures_;
  std::map<std::tuple<std::string, bool, double, std::string>, std::shared_ptr<const Bitmap>>
      bitmaps_;
};

}  // namespace photonloom
