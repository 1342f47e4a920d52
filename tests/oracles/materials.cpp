// SPDX-License-Identifier: Apache-2.0
// BSDFs, textures, open surfaces and environments against their definitions (docs/materials.md):
// samplers against their densities, reciprocity, energy, furnaces, orientations.
#include <turbojpeg.h>

#include <cmath>
#include <cstring>

#include "golden/image/image.hpp"
#include "golden/numeric/elementary.hpp"
#include "golden/numeric/output_file.hpp"
#include "golden/transport/bsdf.hpp"
#include "golden/transport/direct.hpp"
#include "golden/transport/emitters.hpp"
#include "golden/transport/microfacet.hpp"
#include "golden/transport/path.hpp"
#include "golden/transport/sampling.hpp"
#include "golden/transport/visibility.hpp"
#include "tests/catch.hpp"
#include "tests/oracles/scenes.hpp"
#include "tests/oracles/statistics.hpp"
#include "tests/scene_files.hpp"

#define STB_IMAGE_WRITE_STATIC
#define STB_IMAGE_WRITE_IMPLEMENTATION
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"
#include <stb/stb_image_write.h>
#pragma GCC diagnostic pop

using namespace photonloom;
using namespace photonloom::oracle;
using namespace std::string_literals;

namespace {

// A square with one BSDF in z = 0, seen from both sides.
struct Sample {
  std::unique_ptr<World> world;
  std::unique_ptr<RayCaster> caster;

  explicit Sample(const Bsdf& b, const std::vector<Bsdf>& parts = {}) {
    Scene s;
    s.bsdfs = parts;
    const int index = add_bsdf(s, b);
    Shape& square = add_quad(s, index, Vec3(-1, -1, 0), Vec3(2, 0, 0), Vec3(0, 2, 0));
    square.mesh.uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    add_quad(s, -1, Vec3(-1, -1, 9), Vec3(0, 1, 0), Vec3(1, 0, 0)).radiance = Rgb(1);
    world = std::make_unique<World>(s);
    caster = make_double_bvh(*world);
  }
  // As met by light that arrives from `in`.
  Surface from(const Vec3& in, double choice = 0) const {
    const Vec3 d = -glm::normalize(in);
    const Hit hit = caster->closest(Ray{Vec3(0.1, 0.2, 0) - d, d}, nullptr);
    REQUIRE(hit.valid());
    return make_surface(*world, hit, d, choice);
  }
};

Vec3 at_angle(double degrees, double turn = 0.1) {
  const Vec2 t = cos_sin_turns(degrees / 360), p = cos_sin_turns(turn);
  return Vec3(t.y * p.x, t.y * p.y, t.x);
}

Bsdf rough(BsdfKind kind, Microfacets facets, double alpha_u, double alpha_v) {
  Bsdf b;
  b.kind = kind;
  b.microfacets = facets;
  b.alpha_u = alpha_u;
  b.alpha_v = alpha_v;
  b.specular = Rgb(1);
  b.diffuse = Rgb(kind == BsdfKind::kRoughPlastic ? 0.6 : 0);
  b.ior = 1.5;
  return b;
}

struct Case {
  const char* name;
  Bsdf bsdf;
  Vec3 in;
};
std::vector<Case> rough_cases() {
  std::vector<Case> cases;
  for (const auto facets : {Microfacets::kBeckmann, Microfacets::kGgx})
    for (const double degrees : {5.0, 45.0, 75.0}) {
      const Vec3 in = at_angle(degrees);
      cases.push_back({"roughconductor", rough(BsdfKind::kRoughConductor, facets, 0.3, 0.3), in});
      cases.push_back({"anisotropic", rough(BsdfKind::kRoughConductor, facets, 0.25, 0.6), in});
      cases.push_back({"roughplastic", rough(BsdfKind::kRoughPlastic, facets, 0.3, 0.3), in});
      cases.push_back({"roughdielectric", rough(BsdfKind::kRoughDielectric, facets, 0.4, 0.4), in});
      // Without its mirror, so that nothing is chosen.
      Bsdf varnish = rough(BsdfKind::kRoughConductor, facets, 0.3, 0.5);
      varnish.coat_ior = 1.5;
      varnish.coat_specular = Rgb(0);
      varnish.coat_absorption = Rgb(0.2);
      varnish.diffuse = Rgb(0);
      cases.push_back({"coated roughconductor", varnish, in});
      Bsdf followed = rough(BsdfKind::kRoughPlastic, facets, 0.3, 0.3);
      followed.follow_diffuse = true;
      cases.push_back({"followed roughplastic", followed, in});
      cases.push_back({"roughdielectric, from inside",
                       rough(BsdfKind::kRoughDielectric, facets, 0.4, 0.4),
                       Vec3(in.x, in.y, -in.z)});
    }
  return cases;
}

// Of all its lobes, together and apart.
std::vector<Case> principled_cases() {
  Bsdf b;
  b.kind = BsdfKind::kPrincipled;
  b.diffuse = Rgb(0.8, 0.5, 0.2);
  b.ior = 1.5;
  Bsdf metal = b, glass = b, paint = b, cloth = b, all = b;
  metal.principled.metallic = 0.9;
  metal.principled.anisotropic = 0.6;
  glass.principled.spec_trans = 0.8;
  glass.principled.roughness = 0.6;
  paint.principled.clearcoat = 1;
  paint.principled.spec_tint = 0.7;
  cloth.principled.sheen = 1;
  cloth.principled.sheen_tint = 0.5;
  cloth.principled.flatness = 0.6;
  cloth.principled.roughness = 0.9;
  all.principled = {0.55, 0.3, 0.4, 0.5, 0.4, 0.5, 0.6, 0.3, 0.7, 0.1};
  std::vector<Case> cases;
  for (const double degrees : {5.0, 45.0, 75.0}) {
    const Vec3 in = at_angle(degrees), below(in.x, in.y, -in.z);
    for (const auto& [name, bsdf] :
         {std::pair("plain", b), std::pair("metal", metal), std::pair("glass", glass),
          std::pair("paint", paint), std::pair("cloth", cloth), std::pair("all", all)})
      cases.push_back({name, bsdf, in});
    cases.push_back({"glass, from inside", glass, below});
    cases.push_back({"all, from inside", all, below});
  }
  return cases;
}

// Directions in bins of equal solid angle: by x and by the turn about it, so that a lobe about the
// normal lies far from the poles.
constexpr int kRows = 16, kColumns = 16;
Vec3 in_bin(double row, double column) {
  const double z = 1 - 2 * row / kRows;
  return Vec3(z, cos_sin_turns(column / kColumns) * std::sqrt(std::max(0.0, 1 - z * z)));
}
size_t bin_of(const Vec3& d) {
  double turn = angle_of(d.y, std::fabs(d.z)) / (2 * kPi);
  if (d.z < 0) turn = 1 - turn;
  const int row = std::min(static_cast<int>((1 - d.x) / 2 * kRows), kRows - 1);
  return static_cast<size_t>(row * kColumns +
                             std::min(static_cast<int>(turn * kColumns), kColumns - 1));
}
double solid_angle_of_bin() { return 4 * kPi / (kRows * kColumns); }

}  // namespace

TEST_CASE("samplers of rough lobes have the density that they state: chi-square over the sphere") {
  constexpr int kSamples = 100000, kGrid = 24;
  std::vector<Case> cases = rough_cases();
  // Each kind at one angle.
  for (const Case& c : principled_cases())
    if (std::fabs(std::fabs(c.in.z) - at_angle(45).z) < 1e-6) cases.push_back(c);
  for (const Case& c : cases) {
    INFO(c.name << ", " << (c.bsdf.microfacets == Microfacets::kGgx ? "ggx" : "beckmann") << ", z "
                << c.in.z);
    const Sample sample(c.bsdf);
    const Surface s = sample.from(c.in);
    const Random random(7, Phase::kPath, 1);
    std::vector<double> counted(kRows * kColumns, 0), expected(kRows * kColumns, 0);
    double valid = 0, pdf_sum = 0;
    for (uint64_t i = 0; i < kSamples; ++i) {
      const Vec3 d = sample_glossy(s, Vec2(random.unit(i, 0), random.unit(i, 1)));
      if (!(glossy_pdf(s, d) > 0)) continue;  // sent below the surface, or met from behind
      REQUIRE(std::fabs(glm::length(d) - 1) < 1e-9);
      ++valid;
      ++counted[bin_of(d)];
    }
    for (int row = 0; row < kRows; ++row)
      for (int column = 0; column < kColumns; ++column) {
        double& e = expected[static_cast<size_t>(row * kColumns + column)];
        for (int i = 0; i < kGrid; ++i)
          for (int j = 0; j < kGrid; ++j)
            e += glossy_pdf(s, in_bin(row + (i + 0.5) / kGrid, column + (j + 0.5) / kGrid));
        e *= kSamples * solid_angle_of_bin() / (kGrid * kGrid);
        pdf_sum += e / kSamples;
      }
    // What is not sampled is what the density lacks of 1.
    CHECK(std::fabs(pdf_sum - valid / kSamples) < 4 * std::sqrt(0.25 / kSamples) + 1e-3);
    double chi2 = 0, pooled = 0, pooled_expected = 0;
    int freedom = -1;
    for (size_t b = 0; b < counted.size(); ++b) {
      if (expected[b] < 20) {
        pooled += counted[b];
        pooled_expected += expected[b];
        continue;
      }
      chi2 += (counted[b] - expected[b]) * (counted[b] - expected[b]) / expected[b];
      ++freedom;
    }
    if (pooled_expected > 20) {
      chi2 += (pooled - pooled_expected) * (pooled - pooled_expected) / pooled_expected;
      ++freedom;
    }
    REQUIRE(freedom > 3);
    // Sixty cases: five standard deviations of the chi-square distribution.
    INFO("chi2 " << chi2 << " of " << freedom);
    CHECK(chi2 < freedom + 5 * std::sqrt(2.0 * freedom));
  }
}

TEST_CASE("rough lobes and coated bases are reciprocal") {
  const Random random(3, Phase::kPath, 2);
  std::vector<Case> cases = rough_cases();
  for (const Case& c : principled_cases()) cases.push_back(c);
  Bsdf coated;
  coated.diffuse = Rgb(0.7);
  coated.coat_ior = 1.6;
  coated.coat_specular = Rgb(0);
  coated.coat_absorption = Rgb(0.3);
  cases.push_back({"coated diffuse", coated, Vec3(0)});
  for (const Case& c : cases) {
    INFO(c.name);
    const Sample sample(c.bsdf);
    for (uint64_t i = 0; i < 200; ++i) {
      const Vec3 a = sample_sphere(Vec2(random.unit(i, 0), random.unit(i, 1)));
      const Vec3 b = sample_sphere(Vec2(random.unit(i, 2), random.unit(i, 3)));
      if (std::fabs(a.z) < 0.05 || std::fabs(b.z) < 0.05) continue;
      const Surface from_a = sample.from(a), from_b = sample.from(b);
      // Power, so that both directions of glass have f over the square of their own side's index.
      const Rgb ab = glossy_times_cosine(from_a, b, Carried::kPower) / std::fabs(b.z);
      const Rgb ba = glossy_times_cosine(from_b, a, Carried::kPower) / std::fabs(a.z);
      double scale = 1;
      if (c.bsdf.transmits() && a.z * b.z < 0) scale = a.z > 0 ? 1.5 * 1.5 : 1 / (1.5 * 1.5);
      CHECK(ab.y == Approx(ba.y * scale).epsilon(1e-9).margin(1e-12));
      const Rgb dab = diffuse_times_cosine(from_a, b) / std::fabs(b.z);
      const Rgb dba = diffuse_times_cosine(from_b, a) / std::fabs(a.z);
      CHECK(dab.y == Approx(dba.y).epsilon(1e-9).margin(1e-12));
    }
  }
}

namespace {

// Light that the glossy lobe sends on: sampled it is what a grid of directions integrates it to.
Estimate check_integral(const Case& c, uint64_t samples, int grid, double tolerance) {
  const Random random(5, Phase::kPath, 3);
  const Sample sample(c.bsdf);
  const Surface s = sample.from(c.in);
  Tally tally;
  for (uint64_t i = 0; i < samples; ++i) {
    const Vec3 d = sample_glossy(s, Vec2(random.unit(i, 0), random.unit(i, 1)));
    const double pdf = glossy_pdf(s, d);
    tally.add(pdf > 0 ? glossy_times_cosine(s, d, Carried::kPower).y / pdf : 0);
  }
  double integral = 0;
  for (int i = 0; i < grid; ++i)
    for (int j = 0; j < grid; ++j)
      integral +=
          glossy_times_cosine(s, in_bin((i + 0.5) * kRows / grid, (j + 0.5) * kColumns / grid),
                              Carried::kPower)
              .y *
          4 * kPi / (grid * grid);
  const Estimate e = tally.estimate();
  INFO(e.mean << " +- " << e.error << ", integrated " << integral);
  CHECK(std::fabs(e.mean - integral) <= 4 * e.error + tolerance * integral);
  return e;
}

}  // namespace

TEST_CASE("white rough lobes send out at most what arrives: sampled and integrated within 1 %") {
  const Random random(5, Phase::kPath, 3);
  constexpr uint64_t kSamples = 40000;
  constexpr int kGrid = 256;
  for (Case c : rough_cases()) {
    c.bsdf.diffuse = Rgb(0);
    INFO(c.name << ", " << (c.bsdf.microfacets == Microfacets::kGgx ? "ggx" : "beckmann") << ", z "
                << c.in.z);
    const Estimate e = check_integral(c, kSamples, kGrid, 0.01);
    CHECK(e.mean <= 1 + 4 * e.error);
  }
  // Almost smooth ones lose almost nothing.
  for (const auto facets : {Microfacets::kBeckmann, Microfacets::kGgx})
    for (const auto kind : {BsdfKind::kRoughConductor, BsdfKind::kRoughDielectric}) {
      const Sample sample(rough(kind, facets, 0.02, 0.02));
      const Surface s = sample.from(at_angle(30));
      Tally tally;
      for (uint64_t i = 0; i < kSamples; ++i) {
        const Vec3 d = sample_glossy(s, Vec2(random.unit(i, 0), random.unit(i, 1)));
        const double pdf = glossy_pdf(s, d);
        tally.add(pdf > 0 ? glossy_times_cosine(s, d, Carried::kPower).y / pdf : 0);
      }
      CHECK(tally.estimate().mean == Approx(1).margin(0.01));
    }
}

TEST_CASE("principled is the formula of Mitsuba 3, whatever its lobes are made of") {
  // Written in the surface's own frame with signed cosines, as Mitsuba documents it and unlike
  // ours.
  const auto weight = [](double c) { return std::pow(std::clamp(1 - c, 0.0, 1.0), 5); };
  const auto formula = [&](const Bsdf& b, const Vec3& wi, const Vec3& wo) {
    const Principled& p = b.principled;
    const Rgb c = b.diffuse;
    const double brdf = (1 - p.metallic) * (1 - p.spec_trans),
                 bsdf = (1 - p.metallic) * p.spec_trans;
    const bool front = wi.z > 0, same = wi.z * wo.z > 0;
    const double eta = front ? b.ior : 1 / b.ior;
    Vec3 h = glm::normalize(wi + wo * (same ? 1.0 : eta));
    if (h.z < 0) h = -h;
    const double ci = glm::dot(wi, h), co = glm::dot(wo, h);
    const bool compatible = ci * wi.z > 0 && co * wo.z > 0;
    Rgb sum(0);
    const double aspect = std::sqrt(1 - 0.9 * p.anisotropic);
    const double ax = std::max(0.001, p.roughness * p.roughness / aspect);
    const double ay = std::max(0.001, p.roughness * p.roughness * aspect);
    const double e = h.x * h.x / (ax * ax) + h.y * h.y / (ay * ay) + h.z * h.z;
    const double d = 1 / (kPi * ax * ay * e * e);
    const auto smith = [&](const Vec3& v, double x, double y) {
      const double t2 = (v.x * v.x * x * x + v.y * v.y * y * y) / (v.z * v.z);
      return 2 / (1 + std::sqrt(1 + t2));
    };
    const double g = smith(wi, ax, ay) * smith(wo, ax, ay);
    const double f = fresnel_dielectric(std::fabs(ci), eta);
    const double l = luminance(c);
    const auto mix = [](const Rgb& from, const Rgb& to, double t) {
      return from * (1 - t) + to * t;
    };
    if (same && compatible) {
      const double w = weight(std::fabs(ci)), r0 = std::pow((b.ior - 1) / (b.ior + 1), 2);
      const Rgb front_f = Rgb((1 - p.metallic) * (1 - p.spec_tint) * f) +
                          mix(c, Rgb(1), w) * p.metallic +
                          mix(c / l * r0, Rgb(1), w) * ((1 - p.metallic) * p.spec_tint);
      sum += (front ? front_f : Rgb(bsdf * f)) * (d * g / (4 * std::fabs(wi.z)));
      if (front) {
        const double a2 = std::pow(0.1 + (0.001 - 0.1) * p.clearcoat_gloss, 2);
        const double gtr = (a2 - 1) / (kPi * std::log(a2) * (1 + (a2 - 1) * h.z * h.z));
        sum += Rgb(p.clearcoat * 0.25 * (0.04 + 0.96 * w) * gtr * smith(wi, 0.25, 0.25) *
                   smith(wo, 0.25, 0.25) * wo.z);
      }
    }
    if (!same && compatible && bsdf > 0)
      sum += glm::sqrt(c) * (bsdf * std::fabs((1 - f) * d * g * eta * eta * ci * co /
                                              (wi.z * std::pow(ci + eta * co, 2))));
    if (same && front && brdf > 0) {
      const double fo = weight(wo.z), fi = weight(wi.z), rr = 2 * p.roughness * co * co;
      const double diffuse = (1 - fi / 2) * (1 - fo / 2),
                   retro = rr * (fo + fi + fo * fi * (rr - 1));
      const double fss = (1 + (rr / 2 - 1) * fo) * (1 + (rr / 2 - 1) * fi);
      const double flat = 1.25 * (fss * (1 / (wo.z + wi.z) - 0.5) + 0.5);
      sum += c * (brdf * wo.z / kPi * ((diffuse + retro) * (1 - p.flatness) + flat * p.flatness));
      sum += mix(Rgb(1), c / l, p.sheen_tint) * (p.sheen * (1 - p.metallic) * weight(co) * wo.z);
    }
    return sum;
  };
  const Random random(11, Phase::kPath, 4);
  for (const Case& c : principled_cases()) {
    INFO(c.name);
    const Sample sample(c.bsdf);
    for (uint64_t i = 0; i < 100; ++i) {
      const Vec3 in = sample_sphere(Vec2(random.unit(i, 0), random.unit(i, 1)));
      const Vec3 out = sample_sphere(Vec2(random.unit(i, 2), random.unit(i, 3)));
      if (std::fabs(in.z) < 0.02 || std::fabs(out.z) < 0.02) continue;
      const Surface s = sample.from(in);
      const Rgb ours =
          s.black() ? Rgb(0)
                    : diffuse_times_cosine(s, out) + glossy_times_cosine(s, out, Carried::kPower);
      const Rgb theirs = formula(c.bsdf, in, out);
      for (int k = 0; k < 3; ++k) CHECK(ours[k] == Approx(theirs[k]).epsilon(1e-9).margin(1e-12));
    }
  }
}

TEST_CASE("principled lobes are sampled to what they integrate to, within 2 %") {
  constexpr uint64_t kSamples = 20000;
  constexpr int kGrid = 128;
  for (const Case& c : principled_cases()) {
    INFO(c.name << ", z " << c.in.z);
    check_integral(c, kSamples, kGrid, 0.02);
  }
}

TEST_CASE("a coat over white loses what it reflects back down, and no more: within 2 %") {
  // Over diffuse: F(in) + (1 - F(in)) (1 - R), R the share of diffuse light from below.
  for (const double degrees : {0.0, 40.0, 80.0}) {
    Bsdf b;
    b.diffuse = Rgb(1);
    b.coat_ior = 1.5;
    const Sample sample(b);
    const double f = fresnel_dielectric(at_angle(degrees).z, 1.5);
    double kept = 0;
    constexpr int kFine = 4096;
    for (int i = 0; i < kFine; ++i)
      kept += (1 - fresnel_dielectric(std::sqrt((i + 0.5) / kFine), 1 / 1.5)) / kFine;
    double sum = 0;
    constexpr int kChoices = 256, kGrid = 64;
    for (int i = 0; i < kChoices; ++i) {
      const Surface s = sample.from(at_angle(degrees), (i + 0.5) / kChoices);
      CHECK(s.stores);
      if (s.is_delta()) {
        Vec3 out;
        Rgb weight;
        double ior2;
        REQUIRE(sample_delta(s, 0.5, Carried::kRadiance, out, weight, ior2));
        sum += weight.y / kChoices;
        continue;
      }
      for (int j = 0; j < kGrid; ++j) {
        const Vec3 d = sample_diffuse(s, Vec2((j + 0.5) / kGrid, 0.3));
        sum += diffuse_times_cosine(s, d).y / diffuse_pdf(s, d) / (kChoices * kGrid);
      }
    }
    INFO(degrees << " degrees");
    CHECK(sum == Approx(f + (1 - f) * kept).epsilon(0.02));
  }
}

TEST_CASE("a followed diffuse lobe sends on what the same in the map does, and stores nothing") {
  std::vector<Bsdf> cases;
  for (const double degrees : {10.0, 60.0})
    for (const BsdfKind kind :
         {BsdfKind::kPlastic, BsdfKind::kRoughPlastic, BsdfKind::kPrincipled, BsdfKind::kDiffuse}) {
      Bsdf b = rough(kind, Microfacets::kGgx, 0.3, 0.3);
      b.diffuse = Rgb(0.7, 0.5, 0.2);
      if (kind == BsdfKind::kDiffuse) b.coat_ior = 1.4;
      Bsdf followed = b;
      followed.follow_diffuse = true;
      const Sample stored_sample(b), followed_sample(followed);
      for (const double choice : {0.001, 0.4, 0.999}) {
        const Surface s = stored_sample.from(at_angle(degrees), choice),
                      f = followed_sample.from(at_angle(degrees), choice);
        INFO("kind " << static_cast<int>(kind) << ", " << degrees << " degrees, " << choice);
        CHECK(s.stores);
        CHECK_FALSE(f.stores);
        REQUIRE(f.is_delta() == s.is_delta());
        if (s.is_delta()) continue;
        CHECK(is_black(f.diffuse()));
        CHECK(f.diffuse_probability() == 0);
        for (int i = 0; i < 50; ++i) {
          const Vec3 out = at_angle(88.0 * i / 50, 0.37 * i);
          const Rgb whole = diffuse_times_cosine(s, out) + glossy_times_cosine(s, out);
          const Rgb same = diffuse_times_cosine(f, out) + glossy_times_cosine(f, out);
          for (int k = 0; k < 3; ++k) CHECK(same[k] == Approx(whole[k]).epsilon(1e-12));
        }
        // Sampled, with the density of its sampling, it sends on the same sum.
        double sampled = 0, expected = 0;
        constexpr int kGrid = 512;
        for (int i = 0; i < kGrid; ++i)
          for (int j = 0; j < kGrid; ++j) {
            const Vec2 u((i + 0.5) / kGrid, (j + 0.5) / kGrid);
            const Vec3 d = sample_glossy(f, u);
            if (const double pdf = glossy_pdf(f, d); pdf > 0)
              sampled += glossy_times_cosine(f, d).y / pdf / (kGrid * kGrid);
            const Vec3 e = sample_diffuse(s, u);
            expected += diffuse_times_cosine(s, e).y / diffuse_pdf(s, e) / (kGrid * kGrid);
            const Vec3 g = sample_glossy(s, u);
            const double own = is_black(s.glossy_lobe) ? 0 : glossy_pdf(s, g);
            if (own > 0) expected += glossy_times_cosine(s, g).y / own / (kGrid * kGrid);
          }
        CHECK(sampled == Approx(expected).epsilon(0.01));
      }
    }
}

TEST_CASE("coats: a mirror below, absorption by Beer's law, a phong lobe below") {
  const Vec3 in = at_angle(50);
  const double f = fresnel_dielectric(in.z, 1.5), below = std::sqrt(1 - (1 - in.z * in.z) / 2.25);
  Bsdf b;
  b.kind = BsdfKind::kConductor;
  b.specular = Rgb(1);
  b.eta = Rgb(0.2, 1.1, 1.3);
  b.k = Rgb(3.9, 2.6, 2.3);
  b.coat_ior = 1.5;
  b.coat_absorption = Rgb(0, 0.3, 0.8);
  const Sample metal_sample(b);
  const Surface mirror = metal_sample.from(in, 0.7);
  REQUIRE(mirror.is_delta());
  Vec3 out;
  Rgb weight;
  double ior2;
  REQUIRE(sample_delta(mirror, 0.5, Carried::kRadiance, out, weight, ior2));
  const Rgb metal = fresnel_conductor(below, b.eta, b.k);
  for (int k = 0; k < 3; ++k)
    CHECK(weight[k] ==
          Approx(f + (1 - f) * (1 - f) * metal[k] * std::exp(-2 * b.coat_absorption[k] / below)));
  // Straight down and up again, f of the lobe below times both passages over the index squared.
  Bsdf gloss;
  gloss.kind = BsdfKind::kPhong;
  gloss.specular = Rgb(0.4);
  gloss.exponent = 10;
  gloss.coat_ior = 1.5;
  gloss.coat_specular = Rgb(0);
  gloss.coat_absorption = Rgb(0.3);
  const double f0 = std::pow(0.5 / 2.5, 2);
  const Sample sample(gloss);
  const Surface s = sample.from(Vec3(0, 0, 1));
  CHECK(glossy_times_cosine(s, Vec3(0, 0, 1)).y ==
        Approx(0.4 * 12 / (2 * kPi) * std::pow((1 - f0) * std::exp(-0.3), 2) / 2.25));
}

TEST_CASE("a white smooth plastic reflects what arrives, from every side of its coat") {
  // Beyond an index of 32 none of the even midpoints below the coat lies within the critical angle.
  const auto check = [](double ior, bool nonlinear) {
    for (const double degrees : {0.0, 40.0, 80.0}) {
      Bsdf b;
      b.kind = BsdfKind::kPlastic;
      b.diffuse = b.specular = Rgb(1);
      b.ior = ior;
      b.nonlinear = nonlinear;
      const Sample sample(b);
      double sum = 0;
      constexpr int kChoices = 64, kGrid = 64;
      for (int i = 0; i < kChoices; ++i) {
        const Surface s = sample.from(at_angle(degrees), (i + 0.5) / kChoices);
        CHECK(s.stores);
        if (s.is_delta()) {
          Vec3 out;
          Rgb weight;
          double ior2;
          REQUIRE(sample_delta(s, 0.5, Carried::kRadiance, out, weight, ior2));
          sum += weight.y / kChoices;
          continue;
        }
        for (int j = 0; j < kGrid * kGrid; ++j) {
          const Vec3 d = sample_diffuse(s, Vec2((j / kGrid + 0.5) / kGrid, 0.3));
          sum += diffuse_times_cosine(s, d).y / diffuse_pdf(s, d) / (kChoices * kGrid * kGrid);
        }
      }
      INFO("index " << ior << ", " << degrees << " degrees, nonlinear " << nonlinear);
      // One part in 64 of the choices decides between the two.
      CHECK(sum == Approx(1).margin(0.02));
    }
  };
  for (const double ior : {1.49, 3.9, 4.1, 30.0, 1000.0})
    for (const bool nonlinear : {false, true}) check(ior, nonlinear);
}

TEST_CASE("an environment of radiance 1 around white rough plastic of any index is 1 at most") {
  for (const double ior : {1.5, 20.0, 100.0, 1000.0})
    for (const double alpha : {1e-9, 1e-3, 0.01, 0.1}) {
      Bsdf b = rough(BsdfKind::kRoughPlastic, Microfacets::kGgx, alpha, alpha);
      b.diffuse = b.specular = Rgb(1);
      b.ior = ior;
      Scene s;
      Light sky;
      sky.kind = LightKind::kEnvironment;
      s.lights.push_back(sky);
      add_sphere(s, add_bsdf(s, b), Vec3(0), 1);
      set_camera(s, Vec3(0, 0, 3), Vec3(0), Vec3(0, 1, 0), 30, 8, 8);
      INFO("index " << ior << ", alpha " << alpha);
      const double mean = channel_mean(path_image(s, 64, 1), "R");
      CHECK(mean > 0.9);
      CHECK(mean < 1.02);
    }
}

TEST_CASE(
    "an environment of radiance 1 around white plastic and glass is 1 everywhere, within 1 %") {
  Scene s;
  Light sky;
  sky.kind = LightKind::kEnvironment;
  s.lights.push_back(sky);
  Bsdf plastic;
  plastic.kind = BsdfKind::kPlastic;
  plastic.diffuse = plastic.specular = Rgb(1);
  plastic.ior = 1.49;
  add_sphere(s, add_bsdf(s, plastic), Vec3(-1.1, 0, 0), 1);
  Bsdf thin;
  thin.kind = BsdfKind::kThinDielectric;
  thin.specular = Rgb(1);
  thin.ior = 1.5;
  add_sphere(s, add_bsdf(s, thin), Vec3(1.1, 0, 0), 1);
  set_camera(s, Vec3(0, 0, 6), Vec3(0), Vec3(0, 1, 0), 45, 12, 8);
  const World world(s);
  const auto caster = make_embree(world);
  for (const uint64_t seed : kSeeds) {
    PathOptions options;
    options.spp = 64;
    options.seed = seed;
    check_estimate("furnace", seed, image_estimate(render_path(world, *caster, options)), 1, 0.01);
  }
}

TEST_CASE("thin glass: 2 F / (1 + F) goes back, the rest straight on") {
  Bsdf b;
  b.kind = BsdfKind::kThinDielectric;
  b.specular = Rgb(1);
  b.ior = 1.5;
  const Sample sample(b);
  const Vec3 in = at_angle(30);
  const double f = fresnel_dielectric(in.z, 1.5), r = 2 * f / (1 + f);
  const Surface s = sample.from(in);
  Vec3 out;
  Rgb weight;
  double ior2;
  REQUIRE(sample_delta(s, r * 0.999, Carried::kRadiance, out, weight, ior2));
  CHECK(glm::length(out - Vec3(-in.x, -in.y, in.z)) < 1e-12);
  REQUIRE(sample_delta(s, r * 1.001, Carried::kRadiance, out, weight, ior2));
  CHECK(out == -s.in);
  CHECK(weight.y == Approx(1));
  CHECK(ior2 == 1);
}

TEST_CASE("mixtures choose their parts by share; what is left is black") {
  std::vector<Bsdf> parts(2);
  parts[0].diffuse = Rgb(0.25);
  parts[1].kind = BsdfKind::kConductor;
  parts[1].specular = Rgb(1);
  Bsdf mixture;
  mixture.kind = BsdfKind::kMixture;
  mixture.parts = {0, 1};
  mixture.shares = {0.5, 0.25};
  const Sample sample(mixture, parts);
  int diffuse = 0, mirror = 0, black = 0;
  for (int i = 0; i < 100; ++i) {
    const Surface s = sample.from(at_angle(20), (i + 0.5) / 100);
    CHECK(s.stores);  // photons land whatever is chosen
    (s.is_delta() ? mirror : s.black() ? black : diffuse)++;
  }
  CHECK(diffuse == 50);
  CHECK(mirror == 25);
  CHECK(black == 25);
  // A part that is not there has no share of what is met.
  parts[0].opacity = 0;
  const Sample open(mixture, parts);
  mirror = 0;
  for (int i = 0; i < 100; ++i) mirror += open.from(at_angle(20), (i + 0.5) / 100).is_delta();
  CHECK(mirror == 50);
  const Vec3 d(0, 0, -1);
  const Hit hit = open.caster->closest(Ray{Vec3(0.1, 0.2, 1), d}, nullptr);
  CHECK(open.world->opacity(hit, d) == Approx(0.5));
}

TEST_CASE("an open surface weakens shadow rays, is passed at random, and keeps photons whole") {
  // A lamp above a half-open sheet above a floor.
  Scene s;
  Bsdf sheet;
  sheet.diffuse = Rgb(0.5);
  sheet.opacity = 0.25;
  const int grey = add_diffuse(s, Rgb(0.8));
  add_quad(s, grey, Vec3(-1, -1, 0), Vec3(2, 0, 0), Vec3(0, 2, 0));
  Shape& open = add_quad(s, add_bsdf(s, sheet), Vec3(-9, -9, 1), Vec3(18, 0, 0), Vec3(0, 18, 0));
  open.back_bsdf = open.bsdf;
  Light light;
  light.kind = LightKind::kDirectional;
  light.direction = Vec3(0, 0, -1);
  light.intensity = Rgb(2);
  s.lights.push_back(light);
  const World world(s);
  const auto caster = make_double_bvh(world);
  CHECK(world.has_openings());
  // Irradiance on the floor: what passes of the beam, 2 x 0.75; its light comes back through the
  // sheet, and off its lower side, in further bounces that the photons of bounce 0 do not have.
  const PhotonPass pass = trace_global_photons(world, *caster, 40000, 4);
  double floor = 0, sheet_power = 0;
  uint64_t on_sheet = 0, first_on_floor = 0;
  for (const Photon& p : pass.photons) {
    if (p.bounce != 0) continue;
    if (p.position.z < 0.5) {
      floor += p.power.y;
      ++first_on_floor;
    } else {
      sheet_power += p.power.y;
      ++on_sheet;
    }
  }
  REQUIRE(first_on_floor > 50);
  CHECK(floor == Approx(2 * 0.75 * 4).epsilon(4 / std::sqrt(static_cast<double>(first_on_floor))));
  CHECK(sheet_power == Approx(2.0 * 18 * 18).epsilon(0.02));
  // Direct light on the floor.
  const Vec3 down(0, 0, -1);
  const Hit hit = caster->closest(Ray{Vec3(0.1, 0.1, 0.5), down}, nullptr);
  const Surface surface = make_surface(world, hit, down);
  const DirectLight direct =
      direct_light(world, *caster, hit, surface, 0.5, Vec2(0.5), LobeShare{1, 0});
  CHECK(direct.diffuse.y == Approx(2 * 0.75 * 0.8 / kPi));
  // A camera ray is stopped by the sheet with its opacity.
  int stopped = 0;
  const Ray ray{Vec3(0.1, 0.1, 2), down};
  for (int i = 0; i < 4000; ++i)
    stopped += pass_openings(world, *caster, ray, caster->closest(ray, nullptr), (i + 0.5) / 4000)
                   .position.z > 0.5;
  CHECK(stopped == Approx(1000).margin(4 * std::sqrt(4000 * 0.25 * 0.75)));
}

TEST_CASE("environment map: orientation, density, and light on a plane") {
  auto map = std::make_shared<Bitmap>();
  map->width = 16;
  map->height = 8;
  map->texels.assign(16 * 8 * 3, 0);
  // One bright texel: column 5, row 2.
  for (size_t c = 0; c < 3; ++c) map->texels[(2 * 16 + 5) * 3 + c] = 10;
  Light light;
  light.kind = LightKind::kEnvironment;
  light.map = map;
  const Environment env(light);
  // Centre of the texel: u = 5.5 / 16, v = 2.5 / 8; x = sin(theta) sin(2 pi u), z = -sin(theta)
  // cos(2 pi u), y = cos(theta).
  const Vec2 t = cos_sin_turns(2.5 / 16), p = cos_sin_turns(5.5 / 16);
  const Vec3 towards(t.y * p.y, t.x, -t.y * p.x);
  CHECK(env.radiance(towards).y == Approx(10));
  CHECK(env.radiance(-towards).y == 0);
  CHECK(env.radiance(Vec3(0, 1, 0)).y == 0);
  // Halfway to the next texel: half of it.
  const Vec2 q = cos_sin_turns(6.0 / 16);
  CHECK(env.radiance(Vec3(t.y * q.y, t.x, -t.y * q.x)).y == Approx(5));
  // The map turns with its frame: a quarter turn about y brings -z to -x.
  Light turned = light;
  turned.to_world = Mat4(glm::dvec4(0, 0, -1, 0), glm::dvec4(0, 1, 0, 0), glm::dvec4(1, 0, 0, 0),
                         glm::dvec4(0, 0, 0, 1));
  CHECK(Environment(turned).radiance(Vec3(turned.to_world * glm::dvec4(towards, 0))).y ==
        Approx(10));
  // The density: of what is sampled, integrating to 1, and positive where there is light.
  const Random random(9, Phase::kDirect, 1);
  Tally lit;
  for (uint64_t i = 0; i < 20000; ++i) {
    double pdf;
    const Vec3 d = env.sample(Vec2(random.unit(i, 0), random.unit(i, 1)), pdf);
    CHECK(env.pdf(d) == Approx(pdf).epsilon(1e-6));
    lit.add(env.radiance(d).y / pdf);
  }
  double sum = 0, integral = 0;
  constexpr int kGrid = 512;
  for (int i = 0; i < kGrid; ++i)
    for (int j = 0; j < kGrid; ++j) {
      const double z = 1 - 2 * (i + 0.5) / kGrid;
      const Vec2 turn = cos_sin_turns((j + 0.5) / kGrid) * std::sqrt(1 - z * z);
      const Vec3 d(turn.x, z, turn.y);
      sum += env.pdf(d) * 4 * kPi / (kGrid * kGrid);
      integral += env.radiance(d).y * 4 * kPi / (kGrid * kGrid);
      CHECK((env.radiance(d).y == 0 || env.pdf(d) > 0));
    }
  CHECK(sum == Approx(1).epsilon(2e-3));
  const Estimate e = lit.estimate();
  CHECK(std::fabs(e.mean - integral) < 4 * e.error + 2e-3 * integral);
  CHECK(env.integral().y == Approx(integral).epsilon(0.02));
  CHECK(env.brightest() == Approx(10));
}

TEST_CASE("photons of an environment: irradiance on a plane is pi L, within 2 %") {
  Scene s;
  add_quad(s, add_diffuse(s, Rgb(0.5)), Vec3(-1, -1, 0), Vec3(2, 0, 0), Vec3(0, 2, 0));
  Light sky;
  sky.kind = LightKind::kEnvironment;
  sky.intensity = Rgb(0.7);
  s.lights.push_back(sky);
  const World world(s);
  const auto caster = make_double_bvh(world);
  for (const uint64_t seed : kSeeds) {
    const PhotonPass pass = trace_global_photons(world, *caster, 100000, seed);
    check_estimate("irradiance", seed,
                   per_path(pass, [](const Photon& p) { return p.power.y / 4; }), kPi * 0.7, 0.02);
  }
}

TEST_CASE("bitmaps: texels, filters and wraps against hand-computed values") {
  Texture t;
  auto b = std::make_shared<Bitmap>();
  b->width = 4;
  b->height = 2;
  b->channels = 1;
  b->texels = {0, 1, 2, 3, 10, 11, 12, 13};
  t.bitmap = b;
  const auto at = [&](double u, double v) { return texture_value(t, Vec2(u, v)).x; };
  // Centres; row 0 is v = 0.
  CHECK(at(0.125, 0.25) == 0);
  CHECK(at(0.875, 0.25) == 3);
  CHECK(at(0.125, 0.75) == 10);
  CHECK(at(0.25, 0.25) == Approx(0.5));
  CHECK(at(0.125, 0.5) == Approx(5));
  CHECK(at(0, 0.25) == Approx(1.5));  // repeat: between 3 and 0
  CHECK(at(1.125, 0.25) == Approx(0));
  CHECK(at(-0.125, 0.25) == Approx(3));
  t.nearest = true;
  CHECK(at(0.24, 0.49) == 0);
  CHECK(at(0.26, 0.51) == 11);
  CHECK(at(-0.01, 0) == 3);
  t.wrap_u = Wrap::kMirror;
  CHECK(at(-0.01, 0) == 0);
  CHECK(at(1.01, 0) == 3);
  CHECK(at(1.99, 0) == 0);
  t.wrap_u = Wrap::kClamp;
  CHECK(at(-5, 0) == 0);
  CHECK(at(5, 0) == 3);
  t.wrap_u = Wrap::kZero;
  CHECK(at(1.01, 0) == 0);
  t.wrap_u = Wrap::kOne;
  CHECK(at(1.01, 0) == 1);
  t.wrap_u = Wrap::kRepeat;
  t.to_uv = {{{2, 0, 0.25}, {0, 1, 0.5}}};
  CHECK(at(0.01, 0.01) == 11);
  CHECK(at(1e300, -1e300) >= 0);  // far away is still some texel
  CHECK(texture_mean(t).x == Approx(6.5));
  CHECK(texture_max(t) == 13);
  Texture c;
  c.kind = TextureKind::kCheckerboard;
  CHECK(texture_value(c, Vec2(0.2, 0.3)) == Rgb(0.4));
  CHECK(texture_value(c, Vec2(0.7, 0.3)) == Rgb(0.2));
  CHECK(texture_value(c, Vec2(-0.2, 0.7)) == Rgb(0.4));
}

TEST_CASE("texture coordinates of shapes are Mitsuba's") {
  const Scene s = load_body(
      "<bsdf type=\"diffuse\" id=\"b\"><texture name=\"reflectance\" type=\"checkerboard\"/></bsdf>"
      "<shape type=\"rectangle\"><ref id=\"b\"/></shape>"
      "<shape type=\"disk\"><transform name=\"toWorld\"><translate z=\"1\"/></transform><ref "
      "id=\"b\"/></shape>"
      "<shape type=\"sphere\"><point name=\"center\" x=\"0\" y=\"0\" z=\"9\"/><ref "
      "id=\"b\"/></shape>"
      "<shape type=\"cube\"><transform name=\"toWorld\"><translate z=\"-5\"/></transform><ref "
      "id=\"b\"/></shape>");
  const World world(s);
  const auto caster = make_double_bvh(world);
  const auto uv = [&](const Vec3& from, const Vec3& d) {
    const Hit hit = caster->closest(Ray{from, d}, nullptr);
    REQUIRE(hit.valid());
    return world.uv(hit);
  };
  const auto is = [](const Vec2& a, const Vec2& b) { return glm::length(a - b) < 1e-9; };
  CHECK(is(uv(Vec3(0.5, -0.25, 0.5), Vec3(0, 0, -1)), Vec2(0.75, 0.375)));
  CHECK(is(uv(Vec3(0, 0.5, 2), Vec3(0, 0, -1)), Vec2(0.5, 0.25)));
  CHECK(is(uv(Vec3(0, -0.5, 2), Vec3(0, 0, -1)), Vec2(0.5, 0.75)));
  CHECK(is(uv(Vec3(0, 5, 9), Vec3(0, -1, 0)), Vec2(0.25, 0.5)));
  CHECK(is(uv(Vec3(-5, 0, 9), Vec3(1, 0, 0)), Vec2(0.5, 0.5)));
  CHECK(is(uv(Vec3(0, -5, 9), Vec3(0, 1, 0)), Vec2(0.75, 0.5)));
  // Mitsuba's table of the cube: the face y = -1 has (0, 1) at (1, -1, -1), (1, 1) at (1, -1, 1),
  // (1, 0) at (-1, -1, 1) and (0, 0) at (-1, -1, -1).
  CHECK(is(uv(Vec3(0.5, -9, -5.5), Vec3(0, 1, 0)), Vec2(0.25, 0.75)));
  // The face z = 1: (0, 1) at (1, -1), (1, 1) at (1, 1), (1, 0) at (-1, 1), (0, 0) at (-1, -1).
  CHECK(is(uv(Vec3(0.5, -0.5, -3), Vec3(0, 0, -1)), Vec2(0.25, 0.75)));
}

TEST_CASE("pictures of all formats give the same texels; alpha, raw, gamma, gray") {
  const TestFolder folder;
  constexpr uint8_t kRgb[2 * 2 * 3] = {255, 0, 0, 0, 255, 0, 0, 0, 255, 188, 188, 188};
  const std::vector<uint8_t> rgb(kRgb, kRgb + sizeof kRgb);
  write_png(rgb, 2, 2, folder / "a.png");
  const auto collect = [](void* to, void* data, int size) {
    static_cast<std::string*>(to)->append(static_cast<const char*>(data),
                                          static_cast<size_t>(size));
  };
  std::string tga, hdr, jpg, rgba;
  stbi_write_tga_to_func(collect, &tga, 2, 2, 3, kRgb);
  folder.write("a.tga", tga);
  const double grey = srgb_to_linear(188 / 255.0);
  const float linear[2 * 2 * 3] = {1,
                                   0,
                                   0,
                                   0,
                                   1,
                                   0,
                                   0,
                                   0,
                                   1,
                                   static_cast<float>(grey),
                                   static_cast<float>(grey),
                                   static_cast<float>(grey)};
  stbi_write_hdr_to_func(collect, &hdr, 2, 2, 3, linear);
  folder.write("a.hdr", hdr);
  std::vector<uint8_t> flat(16 * 16 * 3, 188);
  stbi_write_jpg_to_func(collect, &jpg, 16, 16, 3, flat.data(), 95);
  folder.write("a.jpg", jpg);
  constexpr uint8_t kAlpha[2 * 4] = {10, 20, 30, 51, 40, 50, 60, 204};
  stbi_write_png_to_func(collect, &rgba, 2, 1, 4, kAlpha, 8);
  folder.write("alpha.png", rgba);
  Image exr;
  exr.width = exr.height = 2;
  for (size_t c = 0; c < 3; ++c)
    for (size_t i = 0; i < 4; ++i) {
      if (i == 0) exr.add(std::string(1, "RGB"[c]));
      exr.channels[c].pixels[i] = linear[3 * i + c];
    }
  write_exr(exr, folder / "a.exr");
  const Bitmap png = load_bitmap(folder / "a.png", {});
  CHECK(png.at(0, 0) == Rgb(1, 0, 0));
  CHECK(png.at(1, 0) == Rgb(0, 1, 0));
  CHECK(png.at(0, 1) == Rgb(0, 0, 1));
  CHECK(png.at(1, 1).x == Approx(grey).epsilon(1e-6));
  CHECK(load_bitmap(folder / "a.tga", {}).texels == png.texels);
  // A chunk of no data stands before the others.
  std::string split = read_file(folder / "a.png");
  REQUIRE(split.find("IDAT") != std::string::npos);
  split.insert(split.find("IDAT") - 4, std::string("\0\0\0\0IDAT\x35\xaf\x06\x1e", 12));
  folder.write("split.png", split);
  CHECK(load_bitmap(folder / "split.png", {}).texels == png.texels);
  CHECK(load_bitmap(folder / "a.exr", {}).texels == png.texels);
  const Bitmap shared = load_bitmap(folder / "a.hdr", {});
  CHECK(shared.at(0, 0) == Rgb(1, 0, 0));
  CHECK(shared.at(1, 1).x == Approx(grey).epsilon(1.0 / 128));
  // A run of no texels, behind which the file ends.
  folder.write("cut.hdr", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 32\n\2\2\0\x20\0"s);
  CHECK_THROWS_WITH(load_bitmap(folder / "cut.hdr", {}),
                    ContainsSubstring("cut.hdr: ends before its last pixel"));
  CHECK(load_bitmap(folder / "a.jpg", {}).at(3, 3).x == Approx(grey).epsilon(0.02));
  // Of gray and of colors; cut short; a table of more codes than there are.
  std::vector<uint8_t> bands;
  for (int i = 0; i < 16 * 16; ++i) bands.insert(bands.end(), {255, 127, 0});
  std::string gray_jpg, color_jpg;
  stbi_write_jpg_to_func(collect, &gray_jpg, 16, 16, 1, flat.data(), 95);
  stbi_write_jpg_to_func(collect, &color_jpg, 16, 16, 3, bands.data(), 95);
  folder.write("gray.jpg", gray_jpg);
  folder.write("color.jpg", color_jpg);
  CHECK(load_bitmap(folder / "gray.jpg", {true, 0, ""}).at(9, 9).x ==
        Approx(188 / 255.0).epsilon(0.01));
  const Rgb band = load_bitmap(folder / "color.jpg", {true, 0, ""}).at(9, 9);
  CHECK(glm::length(band - Rgb(1, 127 / 255.0, 0)) < 0.02);
  folder.write("cut.jpg", color_jpg.substr(0, color_jpg.size() - 8));
  CHECK_THROWS_WITH(
      load_bitmap(folder / "cut.jpg", {}),
      ContainsSubstring("cannot be read as JPEG: ") && ContainsSubstring("Premature"));
  // Bytes that belong to nothing stand before a marker.
  std::string loose = color_jpg;
  REQUIRE(loose.find("\xff\xda") != std::string::npos);
  loose.insert(loose.find("\xff\xda"), "ab");
  folder.write("loose.jpg", loose);
  CHECK(load_bitmap(folder / "loose.jpg", {true, 0, ""}).at(9, 9) == band);
  // Inks, as their complements: red, and half of it under half of the black.
  for (const auto& [black, red] : {std::pair(255, 1.0), std::pair(128, 128 / 255.0)}) {
    std::vector<uint8_t> inks;
    for (int i = 0; i < 16 * 16; ++i)
      inks.insert(inks.end(), {255, 0, 0, static_cast<uint8_t>(black)});
    unsigned char* written = nullptr;
    unsigned long size = 0;
    const tjhandle writer = tjInitCompress();
    REQUIRE(tjCompress2(writer, inks.data(), 16, 0, 16, TJPF_CMYK, &written, &size, TJSAMP_444, 100,
                        0) == 0);
    folder.write("inks.jpg", std::string(reinterpret_cast<char*>(written), size));
    tjFree(written);
    tjDestroy(writer);
    const Rgb mixed = load_bitmap(folder / "inks.jpg", {true, 0, ""}).at(9, 9);
    CHECK(glm::length(mixed - Rgb(red, 0, 0)) < 0.02);
  }
  std::string crowded = color_jpg;
  const size_t table = crowded.find("\xff\xc4");
  REQUIRE(table != std::string::npos);
  for (size_t i = 5; i < 21; ++i) crowded[table + i] = '\xff';
  folder.write("crowded.jpg", crowded);
  CHECK_THROWS_WITH(load_bitmap(folder / "crowded.jpg", {}),
                    ContainsSubstring("crowded.jpg: cannot be read as JPEG: "));
  CHECK(load_bitmap(folder / "a.png", {true, 0, ""}).at(1, 1).x == Approx(188 / 255.0));
  CHECK(load_bitmap(folder / "a.png", {false, 2, ""}).at(1, 1).x ==
        Approx(188 / 255.0 * 188 / 255.0));
  const Bitmap alpha = load_bitmap(folder / "alpha.png", {false, 0, "a"});
  CHECK(alpha.channels == 1);
  CHECK(alpha.at(0, 0).x == Approx(0.2));
  CHECK(alpha.at(1, 0).x == Approx(0.8));
  CHECK(load_bitmap(folder / "alpha.png", {true, 0, "g"}).at(1, 0).x == Approx(50 / 255.0));
  CHECK_THROWS_WITH(load_bitmap(folder / "a.png", {false, 0, "a"}),
                    ContainsSubstring("has no alpha channel"));
}

TEST_CASE("a textured lamp and a textured floor: radiance and light of the point") {
  Scene s;
  auto b = std::make_shared<Bitmap>();
  b->width = 2;
  b->height = 1;
  b->channels = 1;
  b->texels = {0, 2};
  Texture t;
  t.bitmap = b;
  t.nearest = true;
  s.textures.push_back(t);
  Shape& lamp = add_quad(s, -1, Vec3(-1, -1, 2), Vec3(0, 2, 0), Vec3(2, 0, 0));
  lamp.radiance = Rgb(3);
  lamp.radiance_texture = 0;
  lamp.mesh.uvs = {{0, 0}, {0, 1}, {1, 1}, {1, 0}};  // u along x
  Bsdf floor;
  floor.diffuse = Rgb(0.5);
  floor.texture[static_cast<size_t>(Slot::kDiffuse)] = 0;
  const int index = add_bsdf(s, floor);
  Shape& square = add_quad(s, index, Vec3(-1, -1, 0), Vec3(2, 0, 0), Vec3(0, 2, 0));
  square.mesh.uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  const World world(s);
  const auto caster = make_double_bvh(world);
  const Vec3 up(0, 0, 1), down(0, 0, -1);
  CHECK(world.emission(caster->closest(Ray{Vec3(-0.5, 0.1, 1), up}, nullptr), up) == Rgb(0));
  CHECK(world.emission(caster->closest(Ray{Vec3(0.5, 0.1, 1), up}, nullptr), up) == Rgb(6));
  const auto surface = [&](double x) {
    const Hit hit = caster->closest(Ray{Vec3(x, 0.1, 1), down}, nullptr);
    return make_surface(world, hit, down);
  };
  CHECK(surface(-0.5).diffuse() == Rgb(0));
  CHECK(!surface(-0.5).stores);
  CHECK(surface(0.5).diffuse() == Rgb(1));
  // Power: pi L A over the bright half.
  const PhotonPass pass = trace_global_photons(world, *caster, 20000, 2);
  REQUIRE(!pass.photons.empty());
  for (const Photon& p : pass.photons) CHECK(p.position.x >= -1e-9);
  Tally sent;
  for (uint64_t i = 0; i < 20000; ++i)
    sent.add(emit_photon(world, Random(1, Phase::kGlobalPhoton, i)).power.y);
  check_estimate("lamp", 1, sent.estimate(), kPi * 6 * 2, 0.04);
}
