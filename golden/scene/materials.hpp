// SPDX-License-Identifier: Apache-2.0
// Optical constants by name; sources in docs/data.md.
#pragma once
#include <optional>
#include <string>

#include "golden/numeric/vec.hpp"

namespace photonloom {

// Index of refraction of a named medium at 589 nm; capitals do not matter.
std::optional<double> named_ior(const std::string& name);
std::string known_iors();  // for messages

struct ComplexIor {
  Rgb eta, k;
};

// Complex index of a named metal, its spectra projected to linear Rec.709; "none" is an ideal
// mirror. Capitals matter, as in chemistry.
std::optional<ComplexIor> named_metal(const std::string& name);
std::string known_metals();

}  // namespace photonloom
