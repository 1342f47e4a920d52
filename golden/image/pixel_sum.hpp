// SPDX-License-Identifier: Apache-2.0
// The sum of an image's values: what a compression library makes of them does not enter.
#pragma once
#include <string>

#include "golden/image/image.hpp"

namespace photonloom {

// SHA-256, in hexadecimal, of width and height (32-bit) and then, for each channel in the order of
// their names, the name, a zero byte and its floats row by row; all little endian. No metadata.
std::string pixel_sha256(const Image& image);

}  // namespace photonloom
