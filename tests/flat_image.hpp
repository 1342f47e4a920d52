// SPDX-License-Identifier: Apache-2.0
// Images of one value.
#pragma once
#include <vector>

#include "golden/image/image.hpp"

namespace photonloom::test {

inline Image flat_image(int width, int height, float value,
                        const std::vector<const char*>& channels = {"R", "G", "B"}) {
  Image image;
  image.width = width;
  image.height = height;
  for (const char* name : channels)
    for (float& v : image.add(name).pixels) v = value;
  return image;
}

}  // namespace photonloom::test
