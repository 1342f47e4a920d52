// SPDX-License-Identifier: Apache-2.0
#include "golden/scene/texture.hpp"

#include <cmath>

#include "golden/image/image.hpp"
#include "tests/catch.hpp"
#include "tests/scene_files.hpp"

using namespace photonloom;

TEST_CASE("a texel that is no finite number is refused, however it is decoded") {
  const TestFolder folder;
  const std::string path = folder / "texture.exr";
  for (const float bad : {HUGE_VALF, -HUGE_VALF, std::nanf("")})
    for (const Decoding& decoding :
         {Decoding{false, 0, ""}, Decoding{true, 0, ""}, Decoding{false, 2.2, ""},
          Decoding{false, -1, ""}, Decoding{false, 0, "g"}}) {
      Image image;
      image.width = 2;
      image.height = 1;
      for (const char* name : {"R", "G", "B"}) image.add(name);
      image.channels[1].pixels[1] = bad;
      write_exr(image, path);
      INFO("texel " << bad << ", gamma " << decoding.gamma << ", raw " << decoding.raw);
      CHECK_THROWS_WITH(load_bitmap(path, decoding),
                        ContainsSubstring("texel (1, 0) is") && ContainsSubstring(path));
    }
}
