// SPDX-License-Identifier: Apache-2.0
// The plan of a point: what `photonloom plan` writes for the scene and these lines.
#pragma once
#include <string>

#include "golden/plan/plan_file.hpp"
#include "study/study_scene.hpp"

namespace photonloom {

struct PointPlan {
  Plan plan;
  PlanReasons reasons;
  std::string command;  // that writes this plan
};

// With photons of the study's first seed. Throws PlanError where no plan has these lines.
PointPlan plan_of_point(StudyScene& scene, const Study& study, const LineValues& lines);

// Fewest bytes a photon that hold it and fill lines of whole 16 bytes.
int smallest_stride(const Plan& plan);

// Base and point as one list: names without '+', each once, the point's values over the base's.
LineValues joined_lines(const LineValues& base, const LineValues& lines);

}  // namespace photonloom
