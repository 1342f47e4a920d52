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
    {unit_name<PhotonGatherer>, "lut", "list", 2.76128},
    {unit_name<PhotonGatherer>, "lut", "codes", 34.3545},
    {unit_name<PhotonGatherer>, "lut", "lanes", 20.5994},
    {unit_name<PhotonGatherer>, "lut", "flux", 1.11181},
    {unit_name<PhotonGatherer>, "lut", "contexts", 12.0863},
    {unit_name<PhotonGatherer>, "lut", "unit", 2839.82},
    {unit_name<PhotonGatherer>, "lut", "further trees", 61.8727},
    {unit_name<PhotonGatherer>, "lut", "further lists", 1577.95},
    {unit_name<PhotonGatherer>, "lut", "further sums", 4.36365},
    {unit_name<PhotonGatherer>, "lut", "decoder", 0},
    {unit_name<PhotonGatherer>, "lut", "beyond 16 contexts", 1.67785},
    {unit_name<PhotonGatherer>, "lut", "LUT RAM", 1.07579},
    {unit_name<PhotonGatherer>, "ff", "list", 0.255779},
    {unit_name<PhotonGatherer>, "ff", "codes", 2.33884},
    {unit_name<PhotonGatherer>, "ff", "lanes", 50.1843},
    {unit_name<PhotonGatherer>, "ff", "flux", 6.48808},
    {unit_name<PhotonGatherer>, "ff", "contexts", 9.81428},
    {unit_name<PhotonGatherer>, "ff", "unit", 4129.64},
    {unit_name<PhotonGatherer>, "ff", "further trees", 97.1872},
    {unit_name<PhotonGatherer>, "ff", "further lists", 1687.31},
    {unit_name<PhotonGatherer>, "ff", "further sums", 10.8653},
    {unit_name<PhotonGatherer>, "ff", "decoder", 0},
    {unit_name<PhotonGatherer>, "ff", "LUT RAM registers", 1.08678},
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
    {unit_name<PhotonGatherer>, "lut", 0.1269},
    {unit_name<PhotonGatherer>, "ff", 0.0913},
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
