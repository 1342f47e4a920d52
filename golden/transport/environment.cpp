// SPDX-License-Identifier: Apache-2.0
#include "golden/transport/environment.hpp"

#include <algorithm>
#include <cmath>

#include "golden/numeric/elementary.hpp"
#include "golden/transport/sampling.hpp"

namespace photonloom {
namespace {

double mean_of_channels(const Rgb& c) { return (c.x + c.y + c.z) / 3; }

// Longitude and polar angle as parts of the map's width and height.
Vec2 place_of(const Vec3& local) {
  double turn = angle_of(-local.z, std::fabs(local.x)) / (2 * kPi);
  if (local.x < 0) turn = 1 - turn;
  const double across = std::sqrt(local.x * local.x + local.z * local.z);
  return Vec2(turn, angle_of(local.y, across) / kPi);
}

// Mean over a texel of what is interpolated between centres: of its own value 3/4 on each axis, of
// each neighbour's 1/8.
Rgb texel_mean(const Bitmap& map, int x, int y) {
  constexpr double kShare[3] = {0.125, 0.75, 0.125};
  Rgb sum(0);
  for (int j = 0; j < 3; ++j)
    for (int i = 0; i < 3; ++i)
      sum += map.at((x + i - 1 + map.width) % map.width, std::clamp(y + j - 1, 0, map.height - 1)) *
             (kShare[i] * kShare[j]);
  return sum;
}

// The first entry of a running sum beyond u times its last, and where between it and the one
// before.
struct Found {
  size_t index;
  double part;
};
Found find(const double* sums, size_t count, double u) {
  const double at = u * sums[count - 1];
  const size_t i = std::min<size_t>(
      static_cast<size_t>(std::upper_bound(sums, sums + count, at) - sums), count - 1);
  const double before = i > 0 ? sums[i - 1] : 0, width = sums[i] - before;
  return {i, width > 0 ? std::clamp((at - before) / width, 0.0, 0x1.fffffffffffffp-1) : 0.5};
}

}  // namespace

Environment::Environment(const Light& light) : light_(light) {
  for (int i = 0; i < 3; ++i) axis_[i] = glm::normalize(Vec3(light.to_world[i]));
  if (!light.map) {
    integral_ = light.intensity * (4 * kPi);
    brightest_ = max_component(light.intensity);
    return;
  }
  map_.bitmap = light.map;
  map_.wrap_v = Wrap::kClamp;
  const Bitmap& map = *light.map;
  for (int y = 0; y <= map.height; ++y)
    cosines_.push_back(y == map.height ? -1 : cos_sin_turns(0.5 * y / map.height).x);
  double rows = 0;
  for (int y = 0; y < map.height; ++y) {
    const double area = (cosines_[static_cast<size_t>(y)] - cosines_[static_cast<size_t>(y) + 1]) *
                        (2 * kPi / map.width);
    double row = 0;
    for (int x = 0; x < map.width; ++x) {
      const Rgb value = texel_mean(map, x, y) * light.intensity;
      integral_ += value * area;
      brightest_ = std::max(brightest_, max_component(map.at(x, y) * light.intensity));
      texels_.push_back(row += mean_of_channels(value) * area);
    }
    rows_.push_back(rows += row);
  }
}

Vec3 Environment::to_local(const Vec3& d) const {
  return Vec3(glm::dot(d, axis_[0]), glm::dot(d, axis_[1]), glm::dot(d, axis_[2]));
}

Rgb Environment::radiance(const Vec3& direction) const {
  if (!light_.map) return light_.intensity;
  return texture_value(map_, place_of(to_local(direction))) * light_.intensity;
}

Vec3 Environment::sample(const Vec2& u, double& pdf) const {
  if (!light_.map) {
    pdf = 1 / (4 * kPi);
    return sample_sphere(u);
  }
  const Found row = find(rows_.data(), rows_.size(), u.y);
  const double* sums = texels_.data() + row.index * width();
  const Found column = find(sums, width(), u.x);
  const double top = cosines_[row.index], bottom = cosines_[row.index + 1];
  const double y = top + (bottom - top) * row.part;
  const double across = std::sqrt(std::max(0.0, 1 - y * y));
  const Vec2 turn = cos_sin_turns((static_cast<double>(column.index) + column.part) /
                                  static_cast<double>(width()));
  const double weight = sums[column.index] - (column.index > 0 ? sums[column.index - 1] : 0);
  pdf = weight / rows_.back() * static_cast<double>(width()) / (2 * kPi * (top - bottom));
  return axis_[0] * (across * turn.y) + axis_[1] * y - axis_[2] * (across * turn.x);
}

double Environment::pdf(const Vec3& direction) const {
  if (!light_.map) return 1 / (4 * kPi);
  const Vec3 local = to_local(direction);
  const auto x = static_cast<size_t>(place_of(local).x * static_cast<double>(width()));
  const size_t column = std::min(x, width() - 1);
  // Rows by their cosines, which fall.
  const auto at = std::upper_bound(cosines_.begin() + 1, cosines_.end() - 1, local.y,
                                   [](double y, double cosine) { return y > cosine; });
  const auto row = static_cast<size_t>(at - cosines_.begin()) - 1;
  const double* sums = texels_.data() + row * width();
  const double weight = sums[column] - (column > 0 ? sums[column - 1] : 0);
  return weight / rows_.back() * static_cast<double>(width()) /
         (2 * kPi * (cosines_[row] - cosines_[row + 1]));
}

}  // namespace photonloom
