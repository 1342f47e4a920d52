// SPDX-License-Identifier: Apache-2.0
// Spectra as linear Rec.709: lists of wavelengths, .spd files, black bodies. docs/materials.md says
// what a reflectance and what radiance becomes.
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "golden/numeric/vec.hpp"

namespace photonloom {

// Linear between its points, zero outside of them.
struct Spectrum {
  std::vector<double> nm, value;
  double at(double wavelength) const;
};

// What a spectrum is of: radiance and the like keep their unit, so that a flat spectrum has a
// color of its own; reflectances and indices are relative, so that a flat one is grey.
enum class SpectrumOf { kLight, kSurface };

// Through the observer of Wyman, Sloan and Shirley (2013), XYZ with Y = 1 for a spectrum of 1, to
// linear Rec.709; what lies outside the gamut is cut at 0, and of a surface at the spectrum's
// largest value.
Rgb spectrum_color(const Spectrum& spectrum, SpectrumOf of);

// "nm:value" separated by commas or blanks; nm grows. `place` stands before the error.
Spectrum parse_spectrum(std::string_view text, const std::string& place);
// A line each: wavelength in nm, value; # begins a comment. Throws SceneError with file and line.
Spectrum read_spd(const std::string& path);

// Planck's radiance at a wavelength, W/(m^2 sr nm), and the color of its spectrum times `scale`.
double blackbody_radiance(double kelvin, double nm);
Rgb blackbody_color(double kelvin, double scale);

}  // namespace photonloom
