// SPDX-License-Identifier: Apache-2.0
#include "golden/scene/read_bsdf.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "golden/numeric/text.hpp"
#include "golden/scene/materials.hpp"

namespace photonloom {
namespace {

constexpr const char* kBsdfTypes =
    "diffuse, phong, conductor, roughconductor, dielectric, roughdielectric, thindielectric, "
    "plastic, roughplastic, coating, principled, mask, null, blendbsdf, mixturebsdf, bumpmap, "
    "normalmap or twosided";

std::string suffix(const std::string& id, const char* side) { return id.empty() ? id : id + side; }

// Words of one of several spellings.
Wrap wrap_of(Properties& p, const std::string& name, Wrap otherwise) {
  if (!p.has(name)) return otherwise;
  const std::string text = p.text(name, "");
  constexpr std::pair<const char*, Wrap> kWraps[] = {{"repeat", Wrap::kRepeat},
                                                     {"mirror", Wrap::kMirror},
                                                     {"clamp", Wrap::kClamp},
                                                     {"zero", Wrap::kZero},
                                                     {"one", Wrap::kOne}};
  for (const auto& [word, wrap] : kWraps)
    if (text == word) return wrap;
  fail(p.element(name), fmt::format("wrap mode '{}' is unknown, expected repeat, mirror, clamp, "
                                    "zero or one",
                                    text));
}

constexpr int64_t kMaxLeaves = 256;  // of a mixture: each is looked at where light meets it

// Something lies over the diffuse lobe that photons cross on their way to it.
bool has_coat(const Bsdf& b) {
  return b.kind == BsdfKind::kPlastic || b.kind == BsdfKind::kRoughPlastic ||
         b.kind == BsdfKind::kPrincipled || b.is_coated();
}
// One coat over both, or none.
bool same_coat(const Bsdf& a, const Bsdf& b) {
  if (!has_coat(a) || !has_coat(b)) return has_coat(a) == has_coat(b);
  if (a.kind == BsdfKind::kPrincipled || b.kind == BsdfKind::kPrincipled) return a.kind == b.kind;
  if (a.is_coated() || b.is_coated())
    return a.coat_ior == b.coat_ior && a.coat_absorption == b.coat_absorption;
  return a.kind == b.kind && a.ior == b.ior && a.alpha_u == b.alpha_u &&
         a.microfacets == b.microfacets;
}

}  // namespace

void BsdfReader::warn(const Element& e, const std::string& what) {
  scene_.warnings.push_back(fmt::format("{}:{}: {}", *e.file, e.line, what));
}

int BsdfReader::add(const Bsdf& bsdf) {
  scene_.bsdfs.push_back(bsdf);
  return static_cast<int>(scene_.bsdfs.size()) - 1;
}

bool BsdfReader::is_open(int index) const {
  if (index < 0) return false;
  const Bsdf& b = scene_.bsdfs[static_cast<size_t>(index)];
  if (b.opacity < 1 || b.textured(Slot::kOpacity) >= 0) return true;
  return std::any_of(b.parts.begin(), b.parts.end(), [&](int part) { return is_open(part); });
}

bool BsdfReader::lets_light_pass(int index) const {
  if (index < 0) return false;
  const Bsdf& b = scene_.bsdfs[static_cast<size_t>(index)];
  return is_open(index) || b.transmits() ||
         std::any_of(b.parts.begin(), b.parts.end(),
                     [&](int part) { return lets_light_pass(part); });
}

Rgb BsdfReader::textured(Properties& p, const std::string& name, const Rgb& otherwise, int& index,
                         SpectrumOf of) {
  const Properties::Child* child = p.object_of(name);
  if (!child) return p.color(name, otherwise, of);
  if (child->object->tag != "texture") {
    findings_.add(*child->place,
                  fmt::format("{} is not supported as {} of {}, expected a color or a texture",
                              describe(*child->object), name, describe(p.object())),
                  fmt::format("{} takes its default", name));
    return otherwise;
  }
  index = texture(*child->object);
  return Rgb(1);
}

Rgb BsdfReader::value(Properties& p, Bsdf& b, Slot slot, const std::string& name,
                      const Rgb& otherwise) {
  return textured(p, name, otherwise, b.texture[static_cast<size_t>(slot)]);
}

double BsdfReader::largest(const Bsdf& b, Slot slot, const Rgb& factor) const {
  const int t = b.textured(slot);
  return t < 0 ? max_component(factor)
               : max_component(factor) * texture_max(scene_.textures[static_cast<size_t>(t)]);
}

// Mitsuba 0.x scales a BSDF that would reflect more than arrives; 3.x refuses the color.
void BsdfReader::conserve(Properties& p, const Bsdf& b, Rgb& first, Slot slot, Rgb* second) {
  const bool ensure = p.boolean("ensure_energy_conservation", true);
  const bool is_textured = b.textured(slot) >= 0 || (second && b.textured(Slot::kSpecular) >= 0);
  const double most = !second       ? largest(b, slot, first)
                      : is_textured ? largest(b, slot, first) + largest(b, Slot::kSpecular, *second)
                                    : max_component(first + *second);
  if (!(most > 1)) return;
  const Element& e = p.object();
  if (document_.new_dialect || !ensure)
    fail(e, fmt::format("{} reflects {} times the light that arrives, expected at most 1",
                        describe(e), most));
  const double scale = 0.99 / most;
  first *= scale;
  if (second) *second *= scale;
  warn(e, fmt::format("{} reflects {} times the light that arrives and is scaled by {}",
                      describe(e), most, scale));
}

Sides BsdfReader::bsdf(const Element& e, int level) {
  if (const auto at = bsdfs_.find(&e); at != bsdfs_.end()) return at->second;
  if (level > 64) fail(e, "bsdfs are nested more than 64 deep");
  Properties p(document_, e);
  Sides sides;
  const std::string& type = p.type();
  if (type == "twosided") {
    sides = two_sided(p, level);
  } else if (type == "mask") {
    sides = mask(p, level);
  } else if (type == "blendbsdf" || type == "mixturebsdf") {
    sides = mixture(p, level);
  } else if (type == "bumpmap" || type == "normalmap") {
    sides = normals(p, level);
  } else if (type == "coating") {
    sides = coating(p, level);
  } else {
    Bsdf b;
    b.id = e["id"];
    bool known = true;
    if (type == "diffuse") {
      diffuse(p, b);
    } else if (type == "phong") {
      phong(p, b);
    } else if (type == "conductor" || type == "roughconductor") {
      b.kind = type == "conductor" ? BsdfKind::kConductor : BsdfKind::kRoughConductor;
      conductor(p, b);
    } else if (type == "dielectric" || type == "thindielectric" || type == "roughdielectric") {
      b.kind = type == "dielectric"       ? BsdfKind::kDielectric
               : type == "thindielectric" ? BsdfKind::kThinDielectric
                                          : BsdfKind::kRoughDielectric;
      dielectric(p, b);
    } else if (type == "plastic" || type == "roughplastic") {
      b.kind = type == "plastic" ? BsdfKind::kPlastic : BsdfKind::kRoughPlastic;
      plastic(p, b);
    } else if (type == "principled") {
      b.kind = BsdfKind::kPrincipled;
      principled(p, b);
    } else if (type == "null") {
      b.opacity = 0;
    } else {
      known = false;
    }
    if (known) {
      p.no_rest(findings_);
      sides.front = add(b);
      if (b.transmits() || type == "null") sides.back = sides.front;
    } else {
      sides = substitute(p, level);
    }
  }
  p.finish(findings_);
  bsdfs_.emplace(&e, sides);
  return sides;
}

// The nearest that is supported: the BSDF that an unknown one is built on, else a diffuse one of
// its color.
Sides BsdfReader::substitute(Properties& p, int level) {
  const Element& e = p.object();
  const std::string refusal =
      fmt::format("{} is not supported, expected type {}", describe(e), kBsdfTypes);
  const bool rough_coating = p.type() == "roughcoating";
  for (const auto& child : p.children())
    if (child.object->tag == "bsdf") {
      Sides inside = bsdf(*child.object, level + 1);
      Bsdf b;
      if (inside.front >= 0) b = scene_.bsdfs[static_cast<size_t>(inside.front)];
      const bool coats = rough_coating && inside.front >= 0;
      if (coats) b.ior = relative_ior(p, "bk7");
      if (!coats || b.kind != BsdfKind::kDiffuse || b.is_coated() || !(b.ior > 1)) {
        findings_.add(e, refusal, "the BSDF inside of it stands for it");
        p.ignore_all();
        return inside;
      }
      b.id = e["id"];
      b.kind = BsdfKind::kRoughPlastic;
      b.specular = value(p, b, Slot::kSpecular, "specular_reflectance", Rgb(1));
      roughness(p, b);
      if (const int t = b.textured(Slot::kAlphaU); t >= 0)
        b.alpha_u *= luminance(texture_mean(scene_.textures[static_cast<size_t>(t)]));
      b.alpha_v = b.alpha_u = std::max(1e-4, b.alpha_u);
      for (const Slot slot : {Slot::kAlphaU, Slot::kAlphaV})
        b.texture[static_cast<size_t>(slot)] = -1;
      p.ignore_all();
      findings_.add(e, refusal, "a roughplastic of its color stands for it");
      const bool both = inside.back == inside.front;
      inside.front = add(b);
      if (both) inside.back = inside.front;
      return inside;
    }
  Bsdf b;
  b.id = e["id"];
  b.diffuse = Rgb(0.5);
  for (const char* name : {"reflectance", "diffuse_reflectance", "base_color"})
    if (p.has(name) || std::any_of(p.children().begin(), p.children().end(), [&](const auto& c) {
          return canonical_name((*c.place)["name"]) == name;
        }))
      b.diffuse = value(p, b, Slot::kDiffuse, name, Rgb(0.5));
  const double most = largest(b, Slot::kDiffuse, b.diffuse);
  if (most > 1) b.diffuse /= most;
  p.ignore_all();
  findings_.add(e, refusal, "a diffuse BSDF stands for it");
  Sides sides;
  sides.front = sides.back = add(b);
  return sides;
}

// Burley's BSDF as Mitsuba 3 has it.
void BsdfReader::principled(Properties& p, Bsdf& b) {
  const auto within = [&](const char* name, double v) {
    if (!(v >= 0 && v <= 1))
      fail(p.element(name), fmt::format("{} is {}, expected 0 to 1", name, v));
    return v;
  };
  const auto varied = [&](const char* name, Slot slot, double otherwise) {
    const double v = value(p, b, slot, name, Rgb(otherwise)).x;
    return p.has(name) ? within(name, v) : v;
  };
  const auto plain = [&](const char* name) {
    int t = -1;
    const Rgb factor = textured(p, name, Rgb(0), t);
    if (t < 0) return p.has(name) ? within(name, factor.x) : 0.0;
    findings_.add(p.object(),
                  fmt::format("{} has a textured {}, which is not supported, expected a number",
                              describe(p.object()), name),
                  "the texture's mean stands for it");
    return std::clamp(luminance(texture_mean(scene_.textures[static_cast<size_t>(t)])), 0.0, 1.0);
  };
  Principled& q = b.principled;
  b.diffuse = value(p, b, Slot::kDiffuse, "base_color", Rgb(0.5));
  conserve(p, b, b.diffuse, Slot::kDiffuse, nullptr);
  q.roughness = varied("roughness", Slot::kAlphaU, 0.5);
  q.metallic = varied("metallic", Slot::kShare, 0);
  if (b.textured(Slot::kShare) >= 0) q.metallic = 1;
  q.anisotropic = plain("anisotropic");
  q.spec_trans = plain("spec_trans");
  q.spec_tint = plain("spec_tint");
  q.sheen = plain("sheen");
  q.sheen_tint = plain("sheen_tint");
  q.flatness = plain("flatness");
  q.clearcoat = plain("clearcoat");
  q.clearcoat_gloss = plain("clearcoat_gloss");
  if (p.has("eta") && p.has("specular"))
    fail(p.element("specular"),
         fmt::format("{} has both eta and specular, expected one", describe(p.object())));
  if (p.has("eta")) {
    b.ior = p.number("eta", 1.5);
    if (!(b.ior > 0)) fail(p.element("eta"), fmt::format("eta is {}, expected more than 0", b.ior));
    b.ior = checked_ior(p, b.ior);
    if (q.spec_trans > 0 && b.ior == 1) b.ior = 1.001;  // as Mitsuba
  } else {
    double specular = within("specular", p.number("specular", 0.5));
    if (q.spec_trans > 0 && specular == 0) specular = 1e-3;  // as Mitsuba
    b.ior = 2 / (1 - std::sqrt(0.08 * specular)) - 1;
  }
  // Choose a method.
  p.ignore({"main_specular_sampling_rate", "clearcoat_sampling_rate",
            "diffuse_reflectance_sampling_rate"});
}

// A smooth coat over the BSDF inside.
Sides BsdfReader::coating(Properties& p, int level) {
  Bsdf coat;
  int factor = -1, absorption = -1;
  coat.coat_ior = relative_ior(p, "bk7");
  if (!(coat.coat_ior > 1))
    fail(p.object(), fmt::format("{} has the relative index {}, expected more than 1: what it "
                                 "coats lies in the denser medium",
                                 describe(p.object()), coat.coat_ior));
  const auto mean_of = [&](const char* name, Rgb color, int t) {
    if (t < 0) return color;
    findings_.add(p.object(),
                  fmt::format("{} has a textured {}, which is not supported, expected a color",
                              describe(p.object()), name),
                  "the texture's mean stands for it");
    return color * texture_mean(scene_.textures[static_cast<size_t>(t)]);
  };
  const Rgb specular = textured(p, "specular_reflectance", Rgb(1), factor);
  coat.coat_specular = mean_of("specularReflectance", specular, factor);
  if (max_component(coat.coat_specular) > 1)
    fail(p.element("specular_reflectance"),
         fmt::format("specularReflectance is {}, expected at most 1",
                     max_component(coat.coat_specular)));
  const double thickness = p.number("thickness", 1);
  if (!(thickness >= 0))
    fail(p.element("thickness"), fmt::format("thickness is {}, expected at least 0", thickness));
  const Rgb sigma = textured(p, "sigma_a", Rgb(0), absorption);
  coat.coat_absorption = mean_of("sigmaA", sigma, absorption) * thickness;
  const Sides nested = only_bsdf(p, level, "one bsdf");
  p.ignore({"ensure_energy_conservation"});
  bool named = false;
  const auto coated = [&](int index, const char* side) {
    if (index < 0) return index;
    Bsdf b = scene_.bsdfs[static_cast<size_t>(index)];
    const bool bare = b.kind == BsdfKind::kDiffuse || b.kind == BsdfKind::kPhong ||
                      b.kind == BsdfKind::kConductor || b.kind == BsdfKind::kRoughConductor;
    if (!bare || b.is_coated() || is_open(index) || turns_normals(index)) {
      if (!named)
        findings_.add(p.object(),
                      fmt::format("{} coats a BSDF that is coated, open, mixed or transparent or "
                                  "has a bumpmap or normalmap, which is not supported, expected a "
                                  "diffuse, phong, conductor or roughconductor",
                                  describe(p.object())),
                      "the BSDF inside of it stands for it");
      named = true;
      return index;
    }
    b.id = suffix(p.object()["id"], side);
    b.coat_ior = coat.coat_ior;
    b.coat_specular = coat.coat_specular;
    b.coat_absorption = coat.coat_absorption;
    return add(b);
  };
  Sides sides;
  sides.front = coated(nested.front, "");
  sides.back = nested.back == nested.front ? sides.front : coated(nested.back, ".back");
  return sides;
}

void BsdfReader::diffuse(Properties& p, Bsdf& b) {
  if (p.has("reflectance") && p.has("diffuse_reflectance"))
    fail(p.element("diffuse_reflectance"), "diffuseReflectance is another name of reflectance");
  const bool other = p.has("diffuse_reflectance") ||
                     std::any_of(p.children().begin(), p.children().end(), [](const auto& c) {
                       return canonical_name((*c.place)["name"]) == "diffuse_reflectance";
                     });
  b.kind = BsdfKind::kDiffuse;
  b.diffuse = value(p, b, Slot::kDiffuse, other ? "diffuse_reflectance" : "reflectance", Rgb(0.5));
  conserve(p, b, b.diffuse, Slot::kDiffuse, nullptr);
}

void BsdfReader::phong(Properties& p, Bsdf& b) {
  b.kind = BsdfKind::kPhong;
  b.diffuse = value(p, b, Slot::kDiffuse, "diffuse_reflectance", Rgb(0.5));
  b.specular = value(p, b, Slot::kSpecular, "specular_reflectance", Rgb(0.2));
  b.exponent = p.number("exponent", 30);
  if (b.exponent < 0 || b.exponent > 1e15)
    fail(p.element("exponent"), fmt::format("exponent is {}, expected 0 to 1e15", b.exponent));
  conserve(p, b, b.diffuse, Slot::kDiffuse, &b.specular);
}

void BsdfReader::roughness(Properties& p, Bsdf& b) {
  const std::string name = p.text("distribution", "beckmann");
  if (name == "ggx") {
    b.microfacets = Microfacets::kGgx;
  } else if (name != "beckmann") {
    findings_.add(p.element("distribution"),
                  fmt::format("microfacet distribution '{}' is not supported, expected beckmann or "
                              "ggx",
                              name),
                  "beckmann stands for it");
  }
  const auto alpha = [&](const char* key, Slot slot) {
    const double a = value(p, b, slot, key, Rgb(0.1)).x;
    if (p.has(key) && !(a > 0 && a <= 100))
      fail(p.element(key), fmt::format("{} is {}, expected more than 0 and at most 100", key, a));
    return a;
  };
  const auto given = [&](const char* key) {
    return p.has(key) || std::any_of(p.children().begin(), p.children().end(), [&](const auto& c) {
             return canonical_name((*c.place)["name"]) == key;
           });
  };
  if (given("alpha_u") || given("alpha_v")) {
    if (given("alpha"))
      fail(p.object(), fmt::format("{} has both alpha and alphaU, alphaV; expected one of them",
                                   describe(p.object())));
    b.alpha_u = alpha("alpha_u", Slot::kAlphaU);
    b.alpha_v = alpha("alpha_v", Slot::kAlphaV);
  } else {
    b.alpha_u = b.alpha_v = alpha("alpha", Slot::kAlphaU);
    b.texture[static_cast<size_t>(Slot::kAlphaV)] = b.textured(Slot::kAlphaU);
  }
  p.ignore({"sample_visible"});  // chooses a method
}

void BsdfReader::conductor(Properties& p, Bsdf& b) {
  b.specular = value(p, b, Slot::kSpecular, "specular_reflectance", Rgb(1));
  conserve(p, b, b.specular, Slot::kSpecular, nullptr);
  if (p.has("material") && (p.has("eta") || p.has("k")))
    fail(p.element("material"), "the conductor has both material and eta, k; expected one");
  const std::string name = p.text("material", document_.new_dialect ? "none" : "Cu");
  const auto metal = named_metal(name);
  if (!metal)
    fail(p.element("material"),
         fmt::format("material '{}' is unknown, expected one of: {}", name, known_metals()));
  // Relative to the outside; an ideal mirror is one in any medium.
  const double outside = ior(p, "ext_eta", "air");
  const bool given = p.has("eta") || p.has("k");
  if (given && (!p.has("eta") || !p.has("k")))
    fail(p.object(), fmt::format("{} has one of eta and k, expected both", describe(p.object())));
  b.eta = p.color("eta", metal->eta);
  b.k = p.color("k", metal->k);
  // 3.x indices are against vacuum.
  if (!document_.new_dialect || p.has("ext_eta")) {
    b.eta /= outside;
    b.k /= outside;
  }
  for (int i = 0; i < 3; ++i)
    if (given && b.eta[i] == 0 && b.k[i] == 0)
      fail(p.element("eta"), "eta and k are both 0, expected a metal or material \"none\"");
  // The fourth power is a number.
  constexpr double kLargest = 1e70;
  const double largest = std::max(max_component(b.eta), max_component(b.k));
  if (!(largest <= kLargest))
    fail(p.object(), fmt::format("eta or k of {} is {} times the index outside, expected at most "
                                 "{:g} times",
                                 describe(p.object()), largest, kLargest));
  if (b.kind == BsdfKind::kRoughConductor) roughness(p, b);
}

double BsdfReader::ior(Properties& p, const std::string& name, const std::string& otherwise) {
  if (p.has(name) && !p.is_text(name)) {
    const double value = p.number(name, 0);
    if (!(value > 0))
      fail(p.element(name),
           fmt::format("the index of refraction is {}, expected more than 0", value));
    return value;
  }
  const std::string medium = p.text(name, otherwise);
  const auto value = named_ior(medium);
  if (!value)
    fail(p.element(name), fmt::format("medium '{}' is unknown, expected a number or one of: {}",
                                      medium, known_iors()));
  return *value;
}

double BsdfReader::relative_ior(Properties& p, const std::string& otherwise) {
  const double inside = ior(p, "int_ior", otherwise);
  return checked_ior(p, inside / ior(p, "ext_ior", "air"));
}

double BsdfReader::checked_ior(Properties& p, double relative) {
  // Its square is a number, and so is one over it.
  constexpr double kSmallest = 1e-100, kLargest = 1e100;
  if (!(relative >= kSmallest && relative <= kLargest))
    fail(p.object(), fmt::format("the index of refraction of {} is {} times that outside, expected "
                                 "{:g} to {:g} times",
                                 describe(p.object()), relative, kSmallest, kLargest));
  return relative;
}

void BsdfReader::dielectric(Properties& p, Bsdf& b) {
  b.specular = value(p, b, Slot::kSpecular, "specular_reflectance", Rgb(1));
  b.transmission = value(p, b, Slot::kTransmission, "specular_transmittance", Rgb(1));
  conserve(p, b, b.specular, Slot::kSpecular, nullptr);
  conserve(p, b, b.transmission, Slot::kTransmission, nullptr);
  b.ior = relative_ior(p, "bk7");
  if (b.kind != BsdfKind::kRoughDielectric) return;
  roughness(p, b);
  if (b.ior == 1)
    fail(p.object(), fmt::format("{} has the same index inside and outside, expected two that "
                                 "differ",
                                 describe(p.object())));
}

void BsdfReader::plastic(Properties& p, Bsdf& b) {
  b.diffuse = value(p, b, Slot::kDiffuse, "diffuse_reflectance", Rgb(0.5));
  b.specular = value(p, b, Slot::kSpecular, "specular_reflectance", Rgb(1));
  conserve(p, b, b.diffuse, Slot::kDiffuse, nullptr);
  conserve(p, b, b.specular, Slot::kSpecular, nullptr);
  b.ior = relative_ior(p, "polypropylene");
  b.nonlinear = p.boolean("nonlinear", false);
  if (!(b.ior > 1))
    fail(p.object(), fmt::format("{} has the relative index {}, expected more than 1: its diffuse "
                                 "base lies in the denser medium",
                                 describe(p.object()), b.ior));
  if (b.kind != BsdfKind::kRoughPlastic) return;
  roughness(p, b);
  if (b.alpha_u != b.alpha_v)
    fail(p.object(),
         fmt::format("{} has two roughnesses, expected one alpha", describe(p.object())));
  if (b.textured(Slot::kAlphaU) < 0) return;
  const Texture& t = scene_.textures[static_cast<size_t>(b.textured(Slot::kAlphaU))];
  findings_.add(p.object(),
                fmt::format("{} has a textured alpha, which is not supported in roughplastic, "
                            "expected a number",
                            describe(p.object())),
                "the texture's mean stands for it");
  b.alpha_u = b.alpha_v = std::max(1e-4, b.alpha_u * luminance(texture_mean(t)));
  b.texture[static_cast<size_t>(Slot::kAlphaU)] = -1;
  b.texture[static_cast<size_t>(Slot::kAlphaV)] = -1;
}

Sides BsdfReader::two_sided(Properties& p, int level) {
  std::vector<Sides> nested;
  for (const auto& child : p.children()) {
    if (child.object->tag != "bsdf") {
      findings_.add(*child.place,
                    fmt::format("{} is not supported in {}, expected bsdf", describe(*child.object),
                                describe(p.object())),
                    "it is left out");
      continue;
    }
    const Sides sides = bsdf(*child.object, level + 1);
    if (lets_light_pass(sides.front))
      fail(*child.place,
           fmt::format("a {} in <bsdf type=\"twosided\">: it transmits, expected BSDFs that only "
                       "reflect",
                       (*child.object)["type"]));
    nested.push_back(sides);
  }
  p.ignore({"ensure_energy_conservation"});
  if (nested.empty() || nested.size() > 2)
    fail(p.object(),
         fmt::format("{} has {} BSDFs, expected one or two", describe(p.object()), nested.size()));
  Sides sides;
  if (nested.size() == 2) {
    sides.front = nested[0].front;
    sides.back = nested[1].front;
    return sides;
  }
  Bsdf copy = scene_.bsdfs[static_cast<size_t>(nested[0].front)];
  copy.two_sided = true;
  if (!p.object()["id"].empty()) copy.id = p.object()["id"];
  sides.front = sides.back = add(copy);
  return sides;
}

// The BSDF inside with part of it taken away; what has no back is black there, and as open.
Sides BsdfReader::mask(Properties& p, int level) {
  Bsdf black;
  black.opacity = 1;
  int opacity_texture = -1;
  const Rgb opacity = textured(p, "opacity", Rgb(0.5), opacity_texture);
  const double most = opacity_texture < 0
                          ? max_component(opacity)
                          : texture_max(scene_.textures[static_cast<size_t>(opacity_texture)]);
  if (most > 1)
    fail(p.object(),
         fmt::format("the opacity of {} is {}, expected 0 to 1", describe(p.object()), most));
  if (opacity.x != opacity.y || opacity.y != opacity.z)
    findings_.add(p.element("opacity"),
                  fmt::format("{} is colored, which is not supported, expected a grey opacity",
                              describe(p.element("opacity"))),
                  "its luminance stands for it");
  const Sides nested = only_bsdf(p, level, "one bsdf and an opacity");
  if (is_open(nested.front))
    findings_.add(p.object(),
                  fmt::format("{} masks a BSDF that is open itself, which is not supported",
                              describe(p.object())),
                  "the outer opacity stands for both");
  const auto masked = [&](int index, const char* side) {
    Bsdf b = index < 0 ? black : scene_.bsdfs[static_cast<size_t>(index)];
    b.id = suffix(p.object()["id"], side);
    b.opacity = luminance(opacity);
    b.texture[static_cast<size_t>(Slot::kOpacity)] = opacity_texture;
    return add(b);
  };
  Sides sides;
  sides.front = masked(nested.front, "");
  sides.back = nested.back == nested.front ? sides.front : masked(nested.back, ".back");
  return sides;
}

Sides BsdfReader::only_bsdf(Properties& p, int level, const char* expected) {
  std::optional<Sides> nested;
  for (const auto& child : p.rest()) {
    if (child.object->tag == "bsdf" && !nested) {
      nested = bsdf(*child.object, level + 1);
    } else {
      findings_.add(*child.place,
                    fmt::format("{} is not supported in {}, expected {}", describe(*child.object),
                                describe(p.object()), expected),
                    "it is left out");
    }
  }
  if (!nested) fail(p.object(), fmt::format("{} has no BSDF, expected one", describe(p.object())));
  return *nested;
}

// The BSDF inside with its shading normals turned by a texture.
Sides BsdfReader::normals(Properties& p, int level) {
  const bool bump = p.type() == "bumpmap";
  const double scale = bump ? p.number("scale", 1) : 1;
  std::optional<Sides> nested;
  int map = -1;
  for (const auto& child : p.children()) {
    if (child.object->tag == "bsdf" && !nested) {
      nested = bsdf(*child.object, level + 1);
    } else if (child.object->tag == "texture" && map < 0) {
      map = texture(*child.object);
    } else {
      findings_.add(*child.place,
                    fmt::format("{} is not supported in {}, expected one bsdf and one texture",
                                describe(*child.object), describe(p.object())),
                    "it is left out");
    }
  }
  if (!nested) fail(p.object(), fmt::format("{} has no BSDF, expected one", describe(p.object())));
  if (map < 0)
    fail(p.object(), fmt::format("{} has no texture, expected one", describe(p.object())));
  if (scene_.textures[static_cast<size_t>(map)].kind == TextureKind::kVertexColor) {
    findings_.add(
        p.object(),
        fmt::format("{} takes vertex colors, which is not supported, expected a bitmap or "
                    "checkerboard",
                    describe(p.object())),
        "the BSDF inside of it stands for it");
    return *nested;
  }
  if (scale != 1) {
    Texture scaled = scene_.textures[static_cast<size_t>(map)];
    scaled.scale *= scale;
    scene_.textures.push_back(scaled);
    map = static_cast<int>(scene_.textures.size()) - 1;
  }
  const auto turned = [&](int index, const char* side) {
    if (index < 0) return index;
    Bsdf b = scene_.bsdfs[static_cast<size_t>(index)];
    if (turns_normals(index))
      findings_.add(p.object(),
                    fmt::format("{} has a bumpmap or normalmap inside, which is not supported",
                                describe(p.object())),
                    "the outer one stands for both");
    b.id = suffix(p.object()["id"], side);
    (bump ? b.bump_map : b.normal_map) = map;
    (bump ? b.normal_map : b.bump_map) = -1;
    return add(b);
  };
  Sides sides;
  sides.front = turned(nested->front, "");
  sides.back = nested->back == nested->front ? sides.front : turned(nested->back, ".back");
  return sides;
}

int64_t BsdfReader::leaves_of(int index) const {
  if (index < 0) return 0;
  int64_t leaves = 0;
  for (const int part : scene_.bsdfs[static_cast<size_t>(index)].parts) leaves += leaves_of(part);
  return std::max<int64_t>(1, leaves);
}

bool BsdfReader::turns_normals(int index) const {
  if (index < 0) return false;
  const Bsdf& b = scene_.bsdfs[static_cast<size_t>(index)];
  return b.normal_map >= 0 || b.bump_map >= 0;
}

void BsdfReader::keep_one_coat(Bsdf& mixture) {
  // Kinds of coat, none among them, each with its share of the light.
  std::vector<std::pair<const Bsdf*, double>> coats;
  const auto holds_photons = [](const Bsdf& b) {
    return b.kind != BsdfKind::kMixture && b.has_diffuse() && !is_black(b.diffuse);
  };
  const auto look = [&](const auto& again, const Bsdf& b, double share) -> void {
    share *= b.opacity;
    if (share == 0) return;
    if (holds_photons(b)) {
      const auto at = std::find_if(coats.begin(), coats.end(),
                                   [&](const auto& c) { return same_coat(*c.first, b); });
      if (at != coats.end())
        at->second += share;
      else
        coats.emplace_back(&b, share);
    }
    const bool textured = b.textured(Slot::kShare) >= 0;
    for (size_t i = 0; i < b.parts.size(); ++i)
      if (b.parts[i] >= 0)
        again(again, scene_.bsdfs[static_cast<size_t>(b.parts[i])],
              share * (textured ? 0.5 : b.shares[i]));
  };
  look(look, mixture, 1);
  if (coats.size() < 2) return;
  const auto most = std::max_element(
      coats.begin(), coats.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  const Bsdf kept = *most->first;
  std::map<int, int> followed;  // copies of what has other coats
  const auto follow = [&](const auto& again, int index) -> int {
    if (index < 0) return index;
    if (const auto at = followed.find(index); at != followed.end()) return at->second;
    Bsdf b = scene_.bsdfs[static_cast<size_t>(index)];
    const std::vector<int> parts = b.parts;
    for (int& part : b.parts) part = again(again, part);
    const bool has_other_coat = holds_photons(b) && !same_coat(kept, b);
    if (has_other_coat) b.follow_diffuse = true;
    return followed[index] = has_other_coat || parts != b.parts ? add(b) : index;
  };
  for (int& part : mixture.parts) part = follow(follow, part);
}

Sides BsdfReader::mixture(Properties& p, int level) {
  Bsdf front;
  front.kind = BsdfKind::kMixture;
  const bool blend = p.type() == "blendbsdf";
  if (blend) {
    const double weight = value(p, front, Slot::kShare, "weight", Rgb(0.5)).x;
    if (!(weight <= 1))
      fail(p.element("weight"), fmt::format("weight is {}, expected 0 to 1", weight));
    front.shares = {1 - weight, weight};
  } else {
    const std::string weights = p.text("weights", "");
    for (const std::string_view word : split(weights, ", \t\r\n")) {
      const auto share = parse_double(word);
      if (!share || !std::isfinite(*share) || *share < 0)
        fail(p.element("weights"),
             fmt::format("'{}' in weights is not a finite number of at least 0",
                         std::string(word.substr(0, 40))));
      front.shares.push_back(*share);
    }
  }
  std::vector<Sides> nested;
  for (const auto& child : p.rest()) {
    if (child.object->tag == "bsdf") {
      nested.push_back(bsdf(*child.object, level + 1));
    } else {
      findings_.add(*child.place,
                    fmt::format("{} is not supported in {}, expected BSDFs",
                                describe(*child.object), describe(p.object())),
                    "it is left out");
    }
  }
  if (nested.size() != front.shares.size() || nested.empty())
    fail(p.object(), fmt::format("{} has {} BSDFs and {} weights, expected as many of one as of "
                                 "the other, at least one",
                                 describe(p.object()), nested.size(), front.shares.size()));
  double sum = 0;
  for (const double share : front.shares) sum += share;
  const bool ensure = p.boolean("ensure_energy_conservation", true);
  if (sum > 1 && !blend) {
    if (!ensure || !std::isfinite(sum))
      fail(p.element("weights"), fmt::format("weights add up to {}, expected {}", sum,
                                             ensure ? "a finite number" : "at most 1"));
    warn(p.object(),
         fmt::format("weights of {} add up to {} and are scaled to 1", describe(p.object()), sum));
    for (double& share : front.shares) share /= sum;
  }
  for (const Sides& s : nested)
    if (turns_normals(s.front) || turns_normals(s.back))
      findings_.add(p.object(),
                    fmt::format("{} mixes BSDFs with bumpmap or normalmap, which is not supported, "
                                "expected one around it",
                                describe(p.object())),
                    "the maps inside are left out");
  front.id = p.object()["id"];
  Bsdf back = front;
  bool any_back = false, same = true;
  for (const Sides& s : nested) {
    front.parts.push_back(s.front);
    back.parts.push_back(s.back);
    any_back = any_back || s.back >= 0;
    same = same && s.back == s.front;
  }
  int64_t leaves = 0;
  for (const Sides& s : nested) leaves += leaves_of(s.front) + leaves_of(s.back);
  if (leaves > kMaxLeaves)
    fail(p.object(), fmt::format("{} has {} parts, those of mixtures in it and both sides counted, "
                                 "expected at most {}",
                                 describe(p.object()), leaves, kMaxLeaves));
  keep_one_coat(front);
  if (any_back && !same) keep_one_coat(back);
  Sides sides;
  sides.front = add(front);
  back.id = suffix(back.id, ".back");
  sides.back = same ? sides.front : any_back ? add(back) : -1;
  return sides;
}

std::shared_ptr<const Bitmap> BsdfReader::bitmap(Properties& p) {
  if (!p.has("filename")) fail(p.object(), fmt::format("{} has no filename", describe(p.object())));
  const std::string file = document_.find_file(p.element("filename"), p.text("filename", ""));
  Decoding decoding;
  decoding.raw = p.boolean("raw", false);
  decoding.gamma = p.number("gamma", 0);
  if (decoding.gamma < 0 && decoding.gamma != -1)
    fail(p.element("gamma"),
         fmt::format("gamma is {}, expected -1 for sRGB, or more than 0", decoding.gamma));
  decoding.channel = p.text("channel", "");
  const std::string& c = decoding.channel;
  if (!c.empty() && c != "r" && c != "g" && c != "b" && c != "a") {
    findings_.add(p.element("channel"),
                  fmt::format("channel '{}' is not supported, expected r, g, b or a", c),
                  "all channels are read");
    decoding.channel.clear();
  }
  auto& held = bitmaps_[{file, decoding.raw, decoding.gamma, decoding.channel}];
  if (held) return held;
  try {
    held = std::make_shared<const Bitmap>(load_bitmap(file, decoding));
  } catch (const std::runtime_error& error) {
    throw SceneError(fmt::format("{}:{}: {}", *p.object().file, p.object().line, error.what()));
  }
  return held;
}

Rgb BsdfReader::color0or1(Properties& p, const char* name, const Rgb& otherwise) {
  if (const Properties::Child* child = p.object_of(name)) {
    findings_.add(*child->place,
                  fmt::format("{} is not supported as {} of {}, expected a color",
                              describe(*child->object), name, describe(p.object())),
                  "its mean stands for it");
    return child->object->tag == "texture"
               ? texture_mean(scene_.textures[static_cast<size_t>(texture(*child->object))])
               : otherwise;
  }
  return p.color(name, otherwise);
}

int BsdfReader::texture(const Element& e, int level) {
  if (const auto at = textures_.find(&e); at != textures_.end()) return at->second;
  if (level > 64) fail(e, "textures are nested more than 64 deep");
  Properties p(document_, e);
  Texture t;
  bool on_plane = true;  // has coordinates of its own
  if (p.type() == "bitmap") {
    t.bitmap = bitmap(p);
    const std::string filter = p.text("filter_type", "bilinear");
    t.nearest = filter == "nearest";
    // Mitsuba 0.6 filters over the pixel's footprint; its mean over a surface is the same.
    if (!t.nearest && filter != "bilinear" && filter != "trilinear" && filter != "ewa")
      fail(p.element("filter_type"),
           fmt::format("filter type '{}' is unknown, expected nearest, bilinear, trilinear or ewa",
                       filter));
    const Wrap both = wrap_of(p, "wrap_mode", Wrap::kRepeat);
    t.wrap_u = wrap_of(p, "wrap_mode_u", both);
    t.wrap_v = wrap_of(p, "wrap_mode_v", both);
    p.ignore({"cache", "max_anisotropy", "format", "accel"});
  } else if (p.type() == "checkerboard") {
    t.kind = TextureKind::kCheckerboard;
    t.color[0] = color0or1(p, "color0", t.color[0]);
    t.color[1] = color0or1(p, "color1", t.color[1]);
  } else if (p.type() == "vertexcolors" || p.type() == "mesh_attribute") {
    t.kind = TextureKind::kVertexColor;
    on_plane = false;
    if (p.type() == "mesh_attribute") {
      const std::string name = p.text("name", "");
      if (name != "vertex_color")
        findings_.add(
            p.element("name"),
            fmt::format("mesh attribute '{}' is not supported, expected vertex_color", name),
            "vertex_color stands for it");
      t.scale = Rgb(p.number("scale", 1));
    }
  } else if (p.type() == "scale") {
    on_plane = false;
    const Rgb factor = p.color("scale", Rgb(1));
    const Element* inner = nullptr;
    if (const Properties::Child* child = p.object_of("value")) inner = child->object;
    for (const auto& child : p.rest())
      if (!inner) inner = child.object;
    if (inner && inner->tag == "texture") {
      t = scene_.textures[static_cast<size_t>(texture(*inner, level + 1))];
    } else {
      t.kind = TextureKind::kCheckerboard;
      t.color[0] = t.color[1] = p.color("value", Rgb(1));
    }
    t.scale *= factor;
  } else {
    findings_.add(e,
                  fmt::format("{} is not supported, expected type bitmap, checkerboard, "
                              "vertexcolors, mesh_attribute or scale",
                              describe(e)),
                  "the constant 0.5 stands for it");
    t.kind = TextureKind::kCheckerboard;
    t.color[0] = t.color[1] = Rgb(0.5);
    on_plane = false;
    p.ignore_all();
  }
  if (on_plane) {
    if (p.has("to_uv")) {
      const Mat4 m = p.transform("to_uv");
      for (int row = 0; row < 2; ++row)
        t.to_uv[static_cast<size_t>(row)] = {m[0][row], m[1][row], m[3][row]};
    }
    const double both = p.number("uvscale", 1);
    const double su = p.number("uscale", both), sv = p.number("vscale", both);
    const double ou = p.number("uoffset", 0), ov = p.number("voffset", 0);
    for (size_t i = 0; i < 3; ++i) {
      t.to_uv[0][i] *= su;
      t.to_uv[1][i] *= sv;
    }
    t.to_uv[0][2] += ou;
    t.to_uv[1][2] += ov;
    const std::string coordinates = p.text("coordinates", "uv");
    if (coordinates != "uv")
      findings_.add(
          p.element("coordinates"),
          fmt::format("texture coordinates '{}' are not supported, expected uv", coordinates),
          "uv stands for them");
    p.no_rest(findings_);
  }
  p.finish(findings_);
  scene_.textures.push_back(std::move(t));
  const int index = static_cast<int>(scene_.textures.size()) - 1;
  textures_.emplace(&e, index);
  return index;
}

}  // namespace photonloom
