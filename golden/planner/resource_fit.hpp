// SPDX-License-Identifier: Apache-2.0
// Coefficients of the terms in resources.cpp, written by scripts/fpga-plans from fpga/plans.json.
#pragma once

#include "golden/plan/units.hpp"

// clang-format off
namespace photonloom {

struct ResourceCoefficient {
  const char *unit, *resource, *term;
  double coefficient;
};
inline constexpr ResourceCoefficient kResourceCoefficients[] = {
    {unit_name<PhotonGatherer>, "lut", "list", 2.74922},
    {unit_name<PhotonGatherer>, "lut", "codes", 34.5737},
    {unit_name<PhotonGatherer>, "lut", "lanes", 20.5006},
    {unit_name<PhotonGatherer>, "lut", "flux", 1.04853},
    {unit_name<PhotonGatherer>, "lut", "contexts", 12.2409},
    {unit_name<PhotonGatherer>, "lut", "unit", 2852.05},
    {unit_name<PhotonGatherer>, "lut", "further trees", 61.9493},
    {unit_name<PhotonGatherer>, "lut", "further lists", 1591.06},
    {unit_name<PhotonGatherer>, "lut", "further sums", 5.07262},
    {unit_name<PhotonGatherer>, "lut", "decoder", 0},
    {unit_name<PhotonGatherer>, "lut", "beyond 16 contexts", 1.66791},
    {unit_name<PhotonGatherer>, "lut", "LUT RAM", 1.07349},
    {unit_name<PhotonGatherer>, "ff", "list", 0.25218},
    {unit_name<PhotonGatherer>, "ff", "codes", 2.45202},
    {unit_name<PhotonGatherer>, "ff", "lanes", 50.1162},
    {unit_name<PhotonGatherer>, "ff", "flux", 6.40764},
    {unit_name<PhotonGatherer>, "ff", "contexts", 9.7792},
    {unit_name<PhotonGatherer>, "ff", "unit", 4140.23},
    {unit_name<PhotonGatherer>, "ff", "further trees", 97.4978},
    {unit_name<PhotonGatherer>, "ff", "further lists", 1718.99},
    {unit_name<PhotonGatherer>, "ff", "further sums", 11.3909},
    {unit_name<PhotonGatherer>, "ff", "decoder", 0},
    {unit_name<PhotonGatherer>, "ff", "LUT RAM registers", 1.09257},
    {unit_name<PhotonGatherer>, "dsp", "products", 1},
    {unit_name<PhotonGatherer>, "ebr", "memories", 1},
    {unit_name<ReorderBuffer>, "lut", "LUT RAM", 1.18085},
    {unit_name<ReorderBuffer>, "lut", "word", 37.2238},
    {unit_name<ReorderBuffer>, "lut", "tournament", 2.12747},
    {unit_name<ReorderBuffer>, "lut", "numbers", 99.5197},
    {unit_name<ReorderBuffer>, "ff", "LUT RAM registers", 1.36832},
    {unit_name<ReorderBuffer>, "ff", "levels", 4.18031},
    {unit_name<ReorderBuffer>, "ff", "numbers", 95.2061},
    {unit_name<ReorderBuffer>, "dsp", "hash", 2},
    {unit_name<ReorderBuffer>, "ebr", "memories", 1},
    {unit_name<CdfSampler>, "lut", "LUT RAM", 1.05698},
    {unit_name<CdfSampler>, "lut", "search", 1.4254},
    {unit_name<CdfSampler>, "lut", "cosine lanes", 21.7198},
    {unit_name<CdfSampler>, "lut", "powers", 14.3386},
    {unit_name<CdfSampler>, "lut", "combination", 20.6996},
    {unit_name<CdfSampler>, "lut", "draw", 25.7022},
    {unit_name<CdfSampler>, "lut", "place", 0},
    {unit_name<CdfSampler>, "lut", "unit", 0},
    {unit_name<CdfSampler>, "ff", "LUT RAM registers", 1.00642},
    {unit_name<CdfSampler>, "ff", "search", 6.98796},
    {unit_name<CdfSampler>, "ff", "cosine lanes", 9.02445},
    {unit_name<CdfSampler>, "ff", "powers", 0},
    {unit_name<CdfSampler>, "ff", "combination", 24.6349},
    {unit_name<CdfSampler>, "ff", "draw", 13.6469},
    {unit_name<CdfSampler>, "ff", "place", 0},
    {unit_name<CdfSampler>, "ff", "unit", 128.035},
    {unit_name<CdfSampler>, "dsp", "products", 1},
    {unit_name<CdfSampler>, "ebr", "memories", 1},
};

struct ResourceError {
  const char *unit, *resource;
  double error;  // relative, the largest of all plans, each predicted from those not its twins
};
inline constexpr ResourceError kResourceErrors[] = {
    {unit_name<PhotonGatherer>, "lut", 0.1273},
    {unit_name<PhotonGatherer>, "ff", 0.0930},
    {unit_name<PhotonGatherer>, "dsp", 0.0000},
    {unit_name<PhotonGatherer>, "ebr", 0.0000},
    {unit_name<ReorderBuffer>, "lut", 0.1124},
    {unit_name<ReorderBuffer>, "ff", 0.0996},
    {unit_name<ReorderBuffer>, "dsp", 0.0000},
    {unit_name<ReorderBuffer>, "ebr", 0.0000},
    {unit_name<CdfSampler>, "lut", 0.0345},
    {unit_name<CdfSampler>, "ff", 0.0161},
    {unit_name<CdfSampler>, "dsp", 0.0000},
    {unit_name<CdfSampler>, "ebr", 0.0000},
};

}  // namespace photonloom
// clang-format on
