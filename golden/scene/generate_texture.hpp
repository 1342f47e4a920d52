// SPDX-License-Identifier: Apache-2.0
// The pictures of the scenes that come with Photonloom: made, not stored. The same bytes on every
// machine.
#pragma once
#include <string>

namespace photonloom {

// 8-bit sRGB PNGs of 256 x 256 that tile: floor boards along v; a wall of bricks.
void write_planks(const std::string& path);
void write_bricks(const std::string& path);

// An EXR environment of 128 x 64: a clear sky over ground, and a low sun, wide and soft, towards
// -x.
void write_sky(const std::string& path);

}  // namespace photonloom
