// SPDX-License-Identifier: Apache-2.0
// How far an image is from another. Always (a, b): a is judged, b is the reference. Pixels count
// equally, nothing is trimmed or clamped, sums are in double.
#pragma once
#include <array>
#include <string>
#include <vector>

#include "golden/image/image.hpp"

namespace photonloom {

// Three planes of doubles: R, G, B of an image or of a layer.
struct Planes {
  int width = 0, height = 0;
  std::array<std::vector<double>, 3> c;
};

// The planes of a layer: "" for the image itself (channels R, G, B), "direct" for direct.R,
// direct.G, direct.B, "N" for N.X, N.Y, N.Z; a layer of one channel (Z, photonDensity.Y) fills all
// three. Throws std::runtime_error, naming `path`, for a layer that is not there and for a pixel
// that is not finite.
Planes planes_of(const Image& image, const std::string& layer, const std::string& path);

struct Metrics {
  double rmse = 0;        // sqrt(mean (a-b)^2)
  double relmse = 0;      // mean (a-b)^2 / (b^2 + 0.01)
  double mape = 0;        // mean |a-b| / (|b| + 0.01)
  double mean_ratio = 1;  // sum a / sum b over all channels; 1 when both are 0
  std::array<double, 3> mean_ratio_rgb{1, 1, 1};
  double psnr = 0;         // 20 log10(largest b / rmse), dB; infinite for equal images
  double flip = 0;         // mean HDR-FLIP
  bool identical = false;  // the same bits everywhere
};

// Throws std::runtime_error where they are not.
void require_same_size(const Planes& a, const Planes& b);

// Both of the same size, or std::runtime_error. `flip_map`, if not null, gets a value in [0, 1] per
// pixel.
Metrics compare_planes(const Planes& a, const Planes& b, std::vector<double>* flip_map = nullptr);

// HDR-FLIP (Andersson et al. 2021, "Visualizing Errors in Rendered High Dynamic Range Images"): the
// largest LDR-FLIP over exposures between the two at which the ACES curve takes b's brightest and
// median luminance to 0.85. As published for 67.02 pixels per degree. A reference that is black in
// more than half of its pixels takes the median of the others. Both of the same size, or
// std::runtime_error.
std::vector<double> hdr_flip(const Planes& a, const Planes& b);

// LDR-FLIP (Andersson et al. 2020, "FLIP: A Difference Evaluator for Alternating Images") of linear
// RGB in [0, 1].
std::vector<double> ldr_flip(const Planes& a, const Planes& b);

// ACES curve of the above; takes [0, infinity) to [0, 1].
double aces_curve(double x);

}  // namespace photonloom
