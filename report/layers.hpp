// SPDX-License-Identifier: Apache-2.0
// Images as a page carries them: layer by layer, half floats, deflated.
#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "golden/image/image.hpp"
#include "report/payload.hpp"

namespace photonloom {

// Mantissa bits behind the leading one. A run keeps all of a half float's: a relative error of at
// most 2^-11. The images that a study's points share are for looking at: 2^-7.
inline constexpr int kRunMantissa = 10, kStudyMantissa = 6;

// [{name, channels, exponents, difference, chained, payload}]: the layers of docs/frame.md, the
// image itself first under the name "". A channel is stored times 2^-exponent, so that its largest
// value is below 32768, rounded to `mantissa` bits; values below 2^-14 * 2^exponent have a further
// error of up to 2^-25 * 2^exponent. Its halves are differences from their left neighbour (the
// first of a row: from the one above), modulo 2^16, all low bytes before all high bytes. Of a
// "chained" layer each channel after the first is taken less the one before it, first of all.
//
// With `base`, a layer that it has too is stored as the difference from it ("difference": true):
// what two images differ by is often less than a half float's error of either. Its exponent may be
// negative.
nlohmann::ordered_json packed_layers(const Image& image, int mantissa, Payloads& payloads,
                                     const Image* base = nullptr);

// A map of values in [0, 1], 8 bits each; coded as above, one byte plane.
size_t packed_map(const std::vector<double>& map, int width, Payloads& payloads);

}  // namespace photonloom
