// SPDX-License-Identifier: Apache-2.0
// Every order of the final gather gives the committed image of every scene shipped.
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/catch.hpp"
#include "tests/command/run.hpp"

using namespace photonloom::test;

TEST_CASE("every order gives the same image of every scene") {
  std::ifstream list(source("tests/golden_images.sha256"));
  int scenes = 0;
  for (std::string line; std::getline(list, line);) {
    if (line.empty() || line[0] == '#') continue;
    std::istringstream words(line);
    std::string expected, scene, arguments;
    words >> expected >> scene;
    std::getline(words, arguments);
    ++scenes;
    for (const char* made :
         {"frame.order=pixel", "frame.order=tile --set frame.tile=5", "frame.order=direction_bins",
          "frame.order=direction_bins --set frame.tile=64",
          "frame.order=direction_bins --set frame.direction_bin_bits=4 --set frame.batch_tiles=1"})
      for (const char* served :
           {"reorder.key=none", "reorder.key=hash --set reorder.drain=fullest",
            "reorder.key=hilbert --set reorder.drain=sweep --set reorder.packets=64"}) {
        const Scratch scratch;
        const Outcome o = run("render '" + source(scene) + "'" + arguments + " --set " + made +
                              " --set " + served + " -o '" + scratch / "image.exr" + "' --json");
        INFO(line << " --set " << made << " --set " << served << "\n" << o.err);
        REQUIRE(o.status == 0);
        CHECK(nlohmann::json::parse(o.out)["pixels_sha256"] == expected);
      }
  }
  CHECK(scenes >= 6);
}
