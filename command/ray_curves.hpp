// SPDX-License-Identifier: Apache-2.0
// Noise against rays, and what curves of it say beside each other: the measures `noise` and
// `shadows` of points that differ in their number of final gather rays and of shadow rays.
#pragma once
#include <string>
#include <vector>

#include "command/study.hpp"

namespace photonloom {

// A part of a baseline's rays with its standard error.
struct RayPart {
  double value = 0, error = 0;
  int beyond = 0;  // 1: more than the value, the most rays that were measured; -1: less, the fewest
};
// "0.48 ± 0.03", "> 4.0".
std::string text_of(const RayPart& part);

// Where a curve's points are from.
struct RayKind {
  const char* measure;  // with a column `relmse`
  const char* rays;     // its column of rays
  const char* name;     // of the rays, in plots
  const char* first;    // plan line of the first of two passes, "0" for one pass
  const char* mean;     // plan line with the rays asked for of two passes
  const char* fixed;    // likewise of one
};
inline constexpr RayKind kGatherRays{"noise",
                                     "rays",
                                     "final gather rays",
                                     "frame.first_rays",
                                     "frame.mean_rays",
                                     "frame.gather_rays"};
inline constexpr RayKind kAllShadowRays{
    "shadows",          "rays", "shadow rays", "frame.first_shadow_rays", "frame.mean_shadow_rays",
    "frame.shadow_rays"};
inline constexpr RayKind kEmitterRays{"shadows",
                                      "emitter_rays",
                                      "shadow rays to emitters",
                                      "frame.first_shadow_rays",
                                      "frame.mean_shadow_rays",
                                      "frame.shadow_rays"};

// "16": the rays that a row's plan asks for.
std::string asked_rays(const StudyRow& row, const RayKind& kind);

class RayCurve {
 public:
  RayCurve(std::string name, const std::vector<const StudyRow*>& rows, const RayKind& kind);

  const std::string& name() const { return name_; }
  bool empty() const { return points_.empty(); }

  // Rays that this takes to the noise that `base` has with `rays` rays asked for, as a part of the
  // rays that `base` then casts. Between its points, and for a quarter more rays than the last,
  // noise is taken as a power of the rays. Where the noise is beyond, so is the part. The standard
  // error is that of both curves' noise, taken as independent; camera walks are common, so it is
  // rather smaller.
  RayPart part_of(const RayCurve& base, double rays) const;

  // Lines "rays noise error" for gnuplot.
  std::string data() const;

 private:
  struct Point {
    double asked = 0, rays = 0, noise = 0, error = 0;  // rays a camera sample
  };
  std::string name_;
  std::vector<Point> points_;  // by rays
};

// Noise against rays.
Plot plot_curves(const std::string& name, const std::string& title, const RayKind& kind,
                 const std::vector<RayCurve>& curves);

}  // namespace photonloom
