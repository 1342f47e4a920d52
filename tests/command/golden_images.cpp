// SPDX-License-Identifier: Apache-2.0
// The committed sums of golden images come out of this build, with every SIMD level of this machine
// and any number of threads. scripts/golden-images does the same with all compilers.
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <vector>

#include "tests/catch.hpp"
#include "tests/command/run.hpp"

using namespace photonloom::test;

TEST_CASE("golden images have their committed sums") {
  std::ifstream list(source("tests/golden_images.sha256"));
  std::string line;
  std::set<std::string> scenes;
  while (std::getline(list, line)) {
    if (line.empty() || line[0] == '#') continue;
    std::istringstream words(line);
    std::string expected, scene, arguments;
    words >> expected >> scene;
    std::getline(words, arguments);
    scenes.insert(scene);
    const Scratch scratch;
    // Orders of the final gather: of two scenes here, of all in orders_slow.
    std::vector<std::string> variants{"", " --threads 1", " --threads 16"};
    if (scenes.size() <= 2)
      for (const char* order : {"pixel", "direction_bins"})
        variants.push_back(std::string(" --set reorder.key=none --set frame.order=") + order);
    for (const std::string& variant : variants) {
      const Outcome o = run("render '" + source(scene) + "'" + arguments + variant + " -o '" +
                            scratch / "image.exr" + "' --json");
      INFO(line << variant << "\n" << o.err);
      REQUIRE(o.status == 0);
      CHECK(nlohmann::json::parse(o.out)["pixels_sha256"] == expected);
    }
    REQUIRE(setenv("PHOTONLOOM_SIMD", "scalar", 1) == 0);
    const Outcome o = run("render '" + source(scene) + "'" + arguments + " -o '" +
                          scratch / "image.exr" + "' --json");
    unsetenv("PHOTONLOOM_SIMD");
    INFO(line << ", PHOTONLOOM_SIMD=scalar\n" << o.err);
    REQUIRE(o.status == 0);
    CHECK(nlohmann::json::parse(o.out)["pixels_sha256"] == expected);
  }
  for (const auto& entry : std::filesystem::directory_iterator(source("scenes"))) {
    if (entry.path().extension() != ".xml") continue;
    INFO(entry.path().filename() << ": no sum is listed");
    CHECK(scenes.count("scenes/" + entry.path().filename().string()) == 1);
  }
}
