// SPDX-License-Identifier: Apache-2.0
// From results to tables: results.sqlite, results.csv, summary.json, and host.csv for what differs
// from run to run. Equal points and results give equal bytes. docs/sweep.md has the schema.
#pragma once
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "golden/numeric/progress.hpp"
#include "study/point_table.hpp"

namespace photonloom {

// A mean over seeds and its standard error; the ratio to the baseline on the same seeds. NaN where
// there is none.
struct Mean {
  double mean = 0, error = 0, ratio = 0, ratio_error = 0;
};

// Means by "measure.column".
using Means = std::map<std::string, Mean>;

// Results by seed, those of the point and those of its scene's baseline.
Means means_of(const std::vector<Result>& results, const std::vector<Result>& baseline);

struct CollectReport {
  uint64_t points = 0, results = 0, missing = 0, failed = 0, refused = 0;
};
// Whether a stored result of the point has every figure that the study wants, each made with its
// settings; takes out those that were made with others.
using Completeness = std::function<bool(const PlannedPoint&, Result&)>;

// A point is done where all its results are complete. What stands of the others is in the tables
// too.
CollectReport collect(const PointTable& table, const ResultStore& store,
                      const Completeness& complete, Progress* progress = nullptr);

}  // namespace photonloom
