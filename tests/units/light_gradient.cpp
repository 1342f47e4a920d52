// SPDX-License-Identifier: Apache-2.0
// How a record's light changes with its place and normal, against differences of the closed form.
#include "golden/pipeline/light_gradient.hpp"
#include "tests/catch.hpp"

using namespace photonloom;

namespace {

// A plate of radiance 1 over the plane z = 0, beside the origin and inclined, so that its own
// cosine changes along the plane.
constexpr int kSteps = 200;
constexpr double kStep = 1.0 / kSteps, kScale = 0x1p50;

Plan plan_of(CacheGradients gradients) {
  Plan plan;
  plan.extent = 3;
  plan.cache_gradients = gradients;
  return plan;
}

DiffuseHit at(const Vec3& position, const Vec3& normal) {
  DiffuseHit hit{};
  hit.position = position;
  hit.normal = hit.shading_normal = normal;
  return hit;
}

template <class F>
void for_each_place(F&& f) {
  const Vec3 facing = glm::normalize(Vec3(-0.5, 0.25, -1));
  for (int i = 0; i < kSteps; ++i) {
    for (int j = 0; j < kSteps; ++j) {
      const double across = (i + 0.5) * kStep, along = (j + 0.5) * kStep;
      f(at(Vec3(0.2 + across, along - 0.3, 1 - 0.5 * across + 0.25 * along), facing));
    }
  }
}

// What a place of the plate brings to x.
double light_from(const DiffuseHit& x, const DiffuseHit& y) {
  const Vec3 d = y.position - x.position;
  const double r2 = glm::dot(d, d);
  return glm::dot(x.shading_normal, d) * -glm::dot(y.normal, d) / (r2 * r2) * kStep * kStep;
}

double irradiance(const DiffuseHit& x) {
  double sum = 0;
  for_each_place([&](const DiffuseHit& y) { sum += light_from(x, y); });
  return sum;
}

struct Record {
  RecordGradient<Arithmetic::kGolden> gradient;
  double light = 0;
  ClampCounts counts;
  double factor(const Vec3& turn, const Vec3& way, size_t c = 0) {
    return gradient.factor(c, c == 0 ? light : 0, turn, way, counts);
  }
};

Record record_at(const DiffuseHit& x, CacheGradients gradients, bool straight = true) {
  const Plan plan = plan_of(gradients);
  Record record;
  for_each_place([&](const DiffuseHit& y) {
    const auto light = static_cast<uint64_t>(light_from(x, y) * kScale);
    record.light += static_cast<double>(light);
    record.gradient.add({light, 0, 0},
                        ray_gradient(plan, x, glm::normalize(y.position - x.position),
                                     straight ? &y : nullptr, record.counts));
  });
  return record;
}

const Vec3 kUp(0, 0, 1), kNone(0);

}  // namespace

TEST_CASE("a record's light along its surface follows the closed form") {
  const DiffuseHit x = at(Vec3(0), kUp);
  Record record = record_at(x, CacheGradients::kTranslation);
  const double here = irradiance(x), h = 1e-3;
  for (const Vec3& way : {Vec3(h, 0, 0), Vec3(0, h, 0), Vec3(-h, h, 0)}) {
    const double slope = (irradiance(at(way, kUp)) - irradiance(at(-way, kUp))) / (2 * here);
    const double factor = record.factor(kNone, way / 3.0);
    INFO("way " << way.x << " " << way.y << ": " << factor - 1 << ", closed form " << slope);
    CHECK(std::fabs(slope) > 1e-5);
    CHECK(factor - 1 == Approx(slope).epsilon(1e-3));
  }
  // Across the surface nothing is said, nor by a turn.
  CHECK(record.factor(kNone, Vec3(0, 0, h)) == Approx(1).margin(1e-3 * h));
  CHECK(record.factor(Vec3(h, 0, 0), kNone) == 1);
}

TEST_CASE("a record's light under a turn of its normal follows the closed form") {
  const DiffuseHit x = at(Vec3(0), kUp);
  Record record = record_at(x, CacheGradients::kRotation);
  for (const Vec3& axis : {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0.6, -0.8, 0)}) {
    const Vec3 turned = glm::normalize(kUp + axis * 0.05);
    // No place of the plate sets: the light is linear in the normal.
    const double ratio = irradiance(at(Vec3(0), turned)) / irradiance(x);
    const double factor = record.factor(turned - kUp, kNone);
    INFO("axis " << axis.x << " " << axis.y << ": " << factor << ", closed form " << ratio);
    CHECK(factor == Approx(ratio).epsilon(1e-4));
    CHECK(std::fabs(ratio - 1) > 1e-4);
  }
  CHECK(record.factor(kNone, Vec3(0.1, 0, 0)) == 1);
}

TEST_CASE("both gradients, none, and light from elsewhere") {
  const DiffuseHit x = at(Vec3(0), kUp);
  const Vec3 turn(0.01, 0.02, 0), way(0.01, 0, 0);
  const auto change = [&](CacheGradients gradients, bool straight = true) {
    Record r = record_at(x, gradients, straight);
    return r.factor(turn, way) - 1;
  };
  const double turned = change(CacheGradients::kRotation),
               moved = change(CacheGradients::kTranslation);
  CHECK(change(CacheGradients::kBoth) == Approx(turned + moved).epsilon(1e-9));
  CHECK(change(CacheGradients::kNone) == 0);
  CHECK(change(CacheGradients::kBoth, false) == Approx(turned).epsilon(1e-9));
  // No light turns negative, none more than doubles, and a colour without light stays.
  Record far = record_at(x, CacheGradients::kTranslation);
  CHECK(far.factor(kNone, Vec3(0.01, 0, 0)) < 2);
  CHECK(far.counts.changes == 0);
  CHECK(far.factor(kNone, Vec3(-100, 0, 0)) == 0);
  CHECK(far.factor(kNone, Vec3(100, 0, 0)) == 2);
  CHECK(far.counts.changes == 2);
  CHECK(far.factor(kNone, Vec3(100, 0, 0), 1) == 1);
  CHECK(far.counts.changes == 2);
  CHECK(far.counts.gradients == 0);
}

TEST_CASE("what of a ray's gradient does not fit is the largest that does, and counted") {
  const DiffuseHit x = at(Vec3(0), kUp);
  const Plan plan = plan_of(CacheGradients::kBoth);
  const auto gradient = [&](const DiffuseHit& y, ClampCounts& counts) {
    return ray_gradient(plan, x, glm::normalize(y.position), &y, counts);
  };
  ClampCounts counts;
  // (0.6, 0, -0.8) away: by the page turn is omega / cos, and way = 4 omega - n_y / (n_y . omega)
  // over r, less its part along n.
  const DiffuseHit near = at(Vec3(3, 0, 4), Vec3(0, 0, -1));
  RayGradient g = gradient(near, counts);
  CHECK(g.turn == std::array<int32_t, 3>{49152, 0, 65536});
  CHECK(g.way == std::array<int32_t, 3>{5898, 0, 0});  // 4 * 0.6 * 3 / 5 * 2^12, rounded
  CHECK(counts.gradients == 0);
  // Light along the surface: 1 / cos is 2^20, whose 2^16 are beyond 31 bits.
  g = gradient(at(Vec3(1, 0, 0x1p-20), Vec3(-1, 0, 0)), counts);
  CHECK(g.turn == std::array<int32_t, 3>{2147483647, 0, 65536});
  CHECK(counts.gradients == 1);
  // A surface 2^-20 away: the way goes with 1 / r.
  counts = {};
  g = gradient(at(Vec3(-0x1p-20, 0, 0x1p-20), Vec3(0, 0, -1)), counts);
  CHECK(g.way == std::array<int32_t, 3>{-2147483647, 0, 0});
  CHECK(counts.gradients == 1);
}
