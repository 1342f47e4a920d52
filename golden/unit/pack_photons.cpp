// SPDX-License-Identifier: Apache-2.0
#include "golden/unit/pack_photons.hpp"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>

#include "golden/plan/quantiser.hpp"

namespace photonloom {
namespace {

// Power by channel of the plan, W.
std::array<double, 3> channel_powers(const Photon& photon, const Plan& plan) {
  if (plan.channels == 3) return {photon.power.x, photon.power.y, photon.power.z};
  const auto& color = plan.channel_color;
  const auto top = static_cast<int>(std::max_element(color.begin(), color.end()) - color.begin());
  return {photon.power[top] / color[static_cast<size_t>(top)], 0, 0};
}

}  // namespace

PackedPhoton pack(const Photon& photon, const Plan& plan, const MapPlan& map, PackCounts* counts) {
  std::array<double, 3> value = channel_powers(photon, plan);
  bool has_power = false;
  for (double& v : value) {
    has_power |= v > 0;
    v = std::ldexp(v, -map.power_exponent);
  }
  bool saturated = false;
  PackedPhoton packed;
  ClampCounts clamps;
  packed.position = quantise_position(plan, photon.position, &clamps);
  packed.power =
      encode_power(value, plan.channels, plan.mantissa_bits, plan.exponent_bits, &saturated);
  packed.direction = oct_encode(photon.direction, plan.direction_bits);
  packed.flight = photon.flight;
  if (counts) {
    counts->zeroed += has_power && packed.power.mantissa == std::array<uint32_t, 3>{};
    counts->saturated += saturated;
    counts->outside += clamps.positions;
  }
  return packed;
}

std::vector<PackedPhoton> pack_photons(std::span<const Photon> photons, const Plan& plan,
                                       const MapPlan& map, PackCounts* counts) {
  std::vector<PackedPhoton> packed(photons.size());
  std::atomic<uint64_t> zeroed{0}, saturated{0}, outside{0};
  tbb::parallel_for(tbb::blocked_range<size_t>(0, photons.size(), 4096), [&](const auto& range) {
    PackCounts own;
    for (size_t i = range.begin(); i < range.end(); ++i) {
      packed[i] = pack(photons[i], plan, map, &own);
      packed[i].indirect = i > 0 && photons[i - 1].path == photons[i].path;
    }
    zeroed += own.zeroed;
    saturated += own.saturated;
    outside += own.outside;
  });
  if (counts) *counts = {zeroed, saturated, outside};
  return packed;
}

int choose_power_exponent(std::span<const Photon> photons, const Plan& plan) {
  double largest = 0;
  for (const Photon& photon : photons)
    for (const double v : channel_powers(photon, plan)) largest = std::max(largest, v);
  if (largest == 0) return 0;
  // The largest code stands for ones(m) * 2^last units, so the exponent is near log2 of the
  // quotient.
  const int last = static_cast<int>(ones(plan.exponent_bits));
  const double top = static_cast<double>(ones(plan.mantissa_bits));
  const auto fits = [&](int exponent) {
    return std::floor(std::ldexp(largest, -exponent - last) + 0.5) <= top;
  };
  int exponent;
  std::frexp(largest, &exponent);
  exponent -= last + plan.mantissa_bits;
  while (!fits(exponent)) ++exponent;
  while (fits(exponent - 1)) --exponent;
  return exponent;
}

}  // namespace photonloom
