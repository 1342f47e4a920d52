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
    {"photon_gatherer", "lut", "list", 2.80584},
    {"photon_gatherer", "lut", "lanes", 22.0189},
    {"photon_gatherer", "lut", "flux", 1.42814},
    {"photon_gatherer", "lut", "contexts", 10.048},
    {"photon_gatherer", "lut", "unit", 2753.92},
    {"photon_gatherer", "lut", "beyond 16 contexts", 1.75783},
    {"photon_gatherer", "ff", "list", 0.207635},
    {"photon_gatherer", "ff", "lanes", 50.5305},
    {"photon_gatherer", "ff", "flux", 6.72045},
    {"photon_gatherer", "ff", "contexts", 7.809},
    {"photon_gatherer", "ff", "unit", 4148.15},
    {"photon_gatherer", "dsp", "products", 1},
    {"photon_gatherer", "ebr", "memories", 1},
    {"photon_gatherer", "ebr", "unit", 2},
    {"reorder_buffer", "lut", "word", 35.8167},
    {"reorder_buffer", "lut", "tournament", 2.07774},
    {"reorder_buffer", "lut", "numbers", 101.579},
    {"reorder_buffer", "ff", "levels", 4.29587},
    {"reorder_buffer", "ff", "numbers", 94.9195},
    {"reorder_buffer", "dsp", "hash", 2},
    {"reorder_buffer", "ebr", "memories", 1},
    {"cdf_sampler", "lut", "search", 1.42545},
    {"cdf_sampler", "lut", "cosine lanes", 21.7189},
    {"cdf_sampler", "lut", "powers", 14.3932},
    {"cdf_sampler", "lut", "combination", 20.6513},
    {"cdf_sampler", "lut", "draw", 25.7167},
    {"cdf_sampler", "lut", "place", 0},
    {"cdf_sampler", "lut", "unit", 0},
    {"cdf_sampler", "ff", "search", 6.98794},
    {"cdf_sampler", "ff", "cosine lanes", 9.0242},
    {"cdf_sampler", "ff", "powers", 0},
    {"cdf_sampler", "ff", "combination", 24.6356},
    {"cdf_sampler", "ff", "draw", 13.6476},
    {"cdf_sampler", "ff", "place", 0},
    {"cdf_sampler", "ff", "unit", 127.974},
    {"cdf_sampler", "dsp", "products", 1},
    {"cdf_sampler", "ebr", "tables", 1},
    {"cdf_sampler", "ebr", "powers", 1},
};

struct ResourceError {
  const char *unit, *resource;
  double error;  // relative, the largest of all plans, each predicted from the others
};
inline constexpr ResourceError kResourceErrors[] = {
    {"photon_gatherer", "lut", 0.1275},
    {"photon_gatherer", "ff", 0.0585},
    {"photon_gatherer", "dsp", 0.0000},
    {"photon_gatherer", "ebr", 0.0000},
    {"reorder_buffer", "lut", 0.0622},
    {"reorder_buffer", "ff", 0.0567},
    {"reorder_buffer", "dsp", 0.0000},
    {"reorder_buffer", "ebr", 0.0000},
    {"cdf_sampler", "lut", 0.0351},
    {"cdf_sampler", "ff", 0.0159},
    {"cdf_sampler", "dsp", 0.0000},
    {"cdf_sampler", "ebr", 0.0000},
};

}  // namespace photonloom
// clang-format on
