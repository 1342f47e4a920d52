// SPDX-License-Identifier: Apache-2.0
// The points of a study: which lines each sets, in which scene.
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "golden/plan/plan.hpp"
#include "study/study_file.hpp"

namespace photonloom {

struct Point {
  uint32_t number = 0;
  size_t scene = 0;    // of Study::scenes
  LineValues lines;    // beyond the study's base
  int seeds = 0;       // so many first ones of the study's; 0: all
  std::string origin;  // "baseline", "list", "grid", "latin_hypercube seed 7", "search seed 1"
};

// The points of a scene that the file alone decides, numbered from 0: the baseline, then set by
// set. Those of a search follow them.
std::vector<Point> fixed_points(const Study& study, size_t scene);
// So many first seeds has a scene's baseline; 0: all. As many as the point of its scene that has
// most: a further one would be compared with nothing.
int baseline_seeds(const Study& study, size_t scene);
// The seeds that a point is measured with.
std::span<const uint64_t> seeds_of(const Point& point, const std::vector<uint64_t>& seeds);
// How many points a scene has; without those of searches as many as fixed_points() gives.
uint32_t points_of_scene(const Study& study, size_t scene, bool with_searches = true);

// `count` points of a Latin hypercube: each line's values, or its range in `count` equal parts,
// come evenly often; which go together follows from the seed.
std::vector<LineValues> latin_hypercube(const std::vector<LineChoice>& choices, int count,
                                        uint64_t seed);

// The value at u in [0, 1) of a choice.
std::string value_at(const LineChoice& choice, double u);

}  // namespace photonloom
