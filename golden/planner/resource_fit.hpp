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
    {"photon_gatherer", "lut", "list", 2.80376},
    {"photon_gatherer", "lut", "lanes", 22.4953},
    {"photon_gatherer", "lut", "flux", 1.37034},
    {"photon_gatherer", "lut", "contexts", 9.67422},
    {"photon_gatherer", "lut", "unit", 2739.67},
    {"photon_gatherer", "lut", "beyond 16 contexts", 1.77402},
    {"photon_gatherer", "lut", "LUT RAM", 1.07407},
    {"photon_gatherer", "ff", "list", 0.198447},
    {"photon_gatherer", "ff", "lanes", 51.2574},
    {"photon_gatherer", "ff", "flux", 6.5884},
    {"photon_gatherer", "ff", "contexts", 8.37197},
    {"photon_gatherer", "ff", "unit", 4119.19},
    {"photon_gatherer", "ff", "LUT RAM registers", 1.02463},
    {"photon_gatherer", "dsp", "products", 1},
    {"photon_gatherer", "ebr", "memories", 1},
    {"reorder_buffer", "lut", "LUT RAM", 1.18085},
    {"reorder_buffer", "lut", "word", 37.2238},
    {"reorder_buffer", "lut", "tournament", 2.12747},
    {"reorder_buffer", "lut", "numbers", 99.5197},
    {"reorder_buffer", "ff", "LUT RAM registers", 1.36832},
    {"reorder_buffer", "ff", "levels", 4.18031},
    {"reorder_buffer", "ff", "numbers", 95.2061},
    {"reorder_buffer", "dsp", "hash", 2},
    {"reorder_buffer", "ebr", "memories", 1},
    {"cdf_sampler", "lut", "LUT RAM", 1.05698},
    {"cdf_sampler", "lut", "search", 1.4254},
    {"cdf_sampler", "lut", "cosine lanes", 21.7198},
    {"cdf_sampler", "lut", "powers", 14.3386},
    {"cdf_sampler", "lut", "combination", 20.6996},
    {"cdf_sampler", "lut", "draw", 25.7022},
    {"cdf_sampler", "lut", "place", 0},
    {"cdf_sampler", "lut", "unit", 0},
    {"cdf_sampler", "ff", "LUT RAM registers", 1.00642},
    {"cdf_sampler", "ff", "search", 6.98796},
    {"cdf_sampler", "ff", "cosine lanes", 9.02445},
    {"cdf_sampler", "ff", "powers", 0},
    {"cdf_sampler", "ff", "combination", 24.6349},
    {"cdf_sampler", "ff", "draw", 13.6469},
    {"cdf_sampler", "ff", "place", 0},
    {"cdf_sampler", "ff", "unit", 128.035},
    {"cdf_sampler", "dsp", "products", 1},
    {"cdf_sampler", "ebr", "memories", 1},
};

struct ResourceError {
  const char *unit, *resource;
  double error;  // relative, the largest of all plans, each predicted from the others
};
inline constexpr ResourceError kResourceErrors[] = {
    {"photon_gatherer", "lut", 0.1277},
    {"photon_gatherer", "ff", 0.0532},
    {"photon_gatherer", "dsp", 0.0000},
    {"photon_gatherer", "ebr", 0.0000},
    {"reorder_buffer", "lut", 0.1124},
    {"reorder_buffer", "ff", 0.0996},
    {"reorder_buffer", "dsp", 0.0000},
    {"reorder_buffer", "ebr", 0.0000},
    {"cdf_sampler", "lut", 0.0345},
    {"cdf_sampler", "ff", 0.0159},
    {"cdf_sampler", "dsp", 0.0000},
    {"cdf_sampler", "ebr", 0.0000},
};

}  // namespace photonloom
// clang-format on
