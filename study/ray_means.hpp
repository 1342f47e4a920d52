// SPDX-License-Identifier: Apache-2.0
// The measure `ray_means`: whether a plan's final gather rays find the light that cosine-sampled
// ones find of the same photons and camera walks. docs/sampling.md defines the columns.
#pragma once
#include <string>
#include <vector>

#include "study/measures.hpp"

namespace photonloom {

std::vector<Column> ray_means_columns();
Measurement measure_ray_means(PointRun& run);
std::string ray_means_settings(const Study& study, const StudyScene& scene);

}  // namespace photonloom
