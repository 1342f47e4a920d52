// SPDX-License-Identifier: Apache-2.0
// Coefficients of the terms in resources.cpp, written by scripts/fpga-plans from fpga/plans.json.
#pragma once

// clang-format off
namespace photonloom {

struct ResourceCoefficient {
  const char *unit, *resource, *term;
  double coefficient;
};
inline constexpr ResourceCoefficient kResourceCoefficients[] = {
    {"photon_gatherer", "lut", "list", 2.62505},
    {"photon_gatherer", "lut", "lanes", 20.7877},
    {"photon_gatherer", "lut", "flux", 16.1933},
    {"photon_gatherer", "lut", "contexts", 61.2975},
    {"photon_gatherer", "lut", "unit", 603.172},
    {"photon_gatherer", "ff", "list", 0.180321},
    {"photon_gatherer", "ff", "lanes", 46.824},
    {"photon_gatherer", "ff", "flux", 25.4873},
    {"photon_gatherer", "ff", "contexts", 55.8904},
    {"photon_gatherer", "ff", "unit", 1311.76},
    {"photon_gatherer", "dsp", "products", 1},
    {"photon_gatherer", "ebr", "memories", 1},
    {"photon_gatherer", "ebr", "unit", 2},
    {"reorder_buffer", "lut", "counts", 0.418616},
    {"reorder_buffer", "lut", "choice", 49.9997},
    {"reorder_buffer", "lut", "tournament", 1.87649},
    {"reorder_buffer", "lut", "unit", 1248.23},
    {"reorder_buffer", "ff", "levels", 5.48249},
    {"reorder_buffer", "ff", "numbers", 52.6724},
    {"reorder_buffer", "ff", "query", 4.76162},
    {"reorder_buffer", "ff", "unit", 0},
    {"reorder_buffer", "dsp", "hash", 2},
    {"reorder_buffer", "ebr", "memories", 1},
    {"cdf_sampler", "lut", "search", 3.89834},
    {"cdf_sampler", "lut", "cosine lanes", 18.8115},
    {"cdf_sampler", "lut", "powers", 22.5305},
    {"cdf_sampler", "lut", "combination", 10.245},
    {"cdf_sampler", "lut", "draw", 22.7269},
    {"cdf_sampler", "lut", "place", 17.3629},
    {"cdf_sampler", "lut", "unit", 0.000277806},
    {"cdf_sampler", "ff", "search", 10.0061},
    {"cdf_sampler", "ff", "cosine lanes", 5.81971},
    {"cdf_sampler", "ff", "powers", 12.6402},
    {"cdf_sampler", "ff", "combination", 10.1148},
    {"cdf_sampler", "ff", "draw", 7.5138},
    {"cdf_sampler", "ff", "place", 33.0654},
    {"cdf_sampler", "ff", "unit", 0.000529047},
    {"cdf_sampler", "dsp", "products", 1},
    {"cdf_sampler", "ebr", "tables", 1},
    {"cdf_sampler", "ebr", "powers", 1},
};

struct ResourceError {
  const char *unit, *resource;
  double error;  // relative, the largest of all plans, each predicted from the others
};
inline constexpr ResourceError kResourceErrors[] = {
    {"photon_gatherer", "lut", 0.0844},
    {"photon_gatherer", "ff", 0.1439},
    {"photon_gatherer", "dsp", 0.0000},
    {"photon_gatherer", "ebr", 0.0000},
    {"reorder_buffer", "lut", 0.1299},
    {"reorder_buffer", "ff", 0.0348},
    {"reorder_buffer", "dsp", 0.0000},
    {"reorder_buffer", "ebr", 0.0000},
    {"cdf_sampler", "lut", 0.0664},
    {"cdf_sampler", "ff", 0.1194},
    {"cdf_sampler", "dsp", 0.0000},
    {"cdf_sampler", "ebr", 0.0000},
};

}  // namespace photonloom
// clang-format on
