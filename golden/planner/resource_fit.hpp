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
    {unit_name<PhotonGatherer>, "lut", "list", 2.77658},
    {unit_name<PhotonGatherer>, "lut", "codes", 33.3783},
    {unit_name<PhotonGatherer>, "lut", "lanes", 19.6769},
    {unit_name<PhotonGatherer>, "lut", "flux", 1.41563},
    {unit_name<PhotonGatherer>, "lut", "contexts", 14.9756},
    {unit_name<PhotonGatherer>, "lut", "unit", 2538.8},
    {unit_name<PhotonGatherer>, "lut", "leaf cache", 287.687},
    {unit_name<PhotonGatherer>, "lut", "further trees", 57.48},
    {unit_name<PhotonGatherer>, "lut", "further lists", 1581.31},
    {unit_name<PhotonGatherer>, "lut", "further sums", 4.97255},
    {unit_name<PhotonGatherer>, "lut", "decoder", 634.014},
    {unit_name<PhotonGatherer>, "lut", "beyond 16 contexts", 1.57959},
    {unit_name<PhotonGatherer>, "lut", "LUT RAM", 1.06862},
    {unit_name<PhotonGatherer>, "ff", "list", 0.197161},
    {unit_name<PhotonGatherer>, "ff", "codes", 4.91044},
    {unit_name<PhotonGatherer>, "ff", "lanes", 48.6366},
    {unit_name<PhotonGatherer>, "ff", "flux", 6.00279},
    {unit_name<PhotonGatherer>, "ff", "contexts", 9.86853},
    {unit_name<PhotonGatherer>, "ff", "unit", 3898.59},
    {unit_name<PhotonGatherer>, "ff", "leaf cache", 372.713},
    {unit_name<PhotonGatherer>, "ff", "further trees", 87.7612},
    {unit_name<PhotonGatherer>, "ff", "further lists", 1727.14},
    {unit_name<PhotonGatherer>, "ff", "further sums", 12.183},
    {unit_name<PhotonGatherer>, "ff", "decoder", 602.464},
    {unit_name<PhotonGatherer>, "ff", "LUT RAM registers", 1.04844},
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
    {unit_name<CdfSampler>, "lut", "LUT RAM", 1.0546},
    {unit_name<CdfSampler>, "lut", "search", 1.81994},
    {unit_name<CdfSampler>, "lut", "cosine lanes", 21.2528},
    {unit_name<CdfSampler>, "lut", "powers", 11.1358},
    {unit_name<CdfSampler>, "lut", "combination", 23.5113},
    {unit_name<CdfSampler>, "lut", "draw", 24.2977},
    {unit_name<CdfSampler>, "lut", "place", 0},
    {unit_name<CdfSampler>, "lut", "unit", 0},
    {unit_name<CdfSampler>, "ff", "LUT RAM registers", 0.973471},
    {unit_name<CdfSampler>, "ff", "search", 4.86155},
    {unit_name<CdfSampler>, "ff", "cosine lanes", 12.1949},
    {unit_name<CdfSampler>, "ff", "powers", 0},
    {unit_name<CdfSampler>, "ff", "combination", 25.1183},
    {unit_name<CdfSampler>, "ff", "draw", 15.6135},
    {unit_name<CdfSampler>, "ff", "place", 0},
    {unit_name<CdfSampler>, "ff", "unit", 76.6269},
    {unit_name<CdfSampler>, "dsp", "products", 1},
    {unit_name<CdfSampler>, "ebr", "memories", 1},
};

struct ResourceError {
  const char *unit, *resource;
  double error;  // relative, the largest of all plans, each predicted from those not its twins
};
inline constexpr ResourceError kResourceErrors[] = {
    {unit_name<PhotonGatherer>, "lut", 0.1260},
    {unit_name<PhotonGatherer>, "ff", 0.0961},
    {unit_name<PhotonGatherer>, "dsp", 0.0000},
    {unit_name<PhotonGatherer>, "ebr", 0.0000},
    {unit_name<ReorderBuffer>, "lut", 0.1124},
    {unit_name<ReorderBuffer>, "ff", 0.0996},
    {unit_name<ReorderBuffer>, "dsp", 0.0000},
    {unit_name<ReorderBuffer>, "ebr", 0.0000},
    {unit_name<CdfSampler>, "lut", 0.0244},
    {unit_name<CdfSampler>, "ff", 0.0341},
    {unit_name<CdfSampler>, "dsp", 0.0000},
    {unit_name<CdfSampler>, "ebr", 0.0000},
};

}  // namespace photonloom
// clang-format on
