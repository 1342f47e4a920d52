// SPDX-License-Identifier: Apache-2.0
// Mitsuba 0.6's own mesh files (.serialized): several meshes in one file, each compressed by zlib.
#pragma once
#include <cstdint>
#include <string>

#include "golden/scene/mesh.hpp"

namespace photonloom {

// The mesh number `index`, counted from 0. Throws SceneError with the file and what was expected,
// as read_obj does; never holds more than the file's data can fill.
MeshFile read_serialized(const std::string& path, int64_t index);

}  // namespace photonloom
