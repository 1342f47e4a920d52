// SPDX-License-Identifier: Apache-2.0
// A unit alone on a part.
#pragma once
#include <string>

namespace photonloom {

// The module `top`: `unit` between a shift register and a signature register, clocked by the port
// `clock`. Every input comes from a flip-flop and every output ends in one, so that what is routed
// is the unit's own paths.
std::string write_unit_top(const std::string& top, const std::string& unit,
                           const std::string& clock, const std::string& rtl_dir);

}  // namespace photonloom
