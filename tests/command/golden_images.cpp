// SPDX-License-Identifier: Apache-2.0
// The committed sums of golden images come out of this build, with every SIMD level of this machine
// and any number of threads. scripts/golden-images does the same with all compilers.
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <vector>

#include "tests/catch.hpp"
#include "tests/command/run.hpp"

using namespace photonloom::test;

namespace {

const std::string kScalar = "PHOTONLOOM_SIMD=scalar";  // in the environment, no argument

// Renders each scene of the list by its line, with what `variants` adds for the number of the
// scene, and compares the sums.
std::set<std::string> check_sums(
    const std::function<std::vector<std::string>(size_t scene)>& variants) {
  std::ifstream list(source("tests/golden_images.sha256"));
  std::string line;
  std::set<std::string> scenes;
  while (std::getline(list, line)) {
    if (line.empty() || line[0] == '#') continue;
    std::istringstream words(line);
    std::string expected, scene, arguments;
    words >> expected >> scene;
    std::getline(words, arguments);
    const Scratch scratch;
    for (const std::string& variant : variants(scenes.size())) {
      const bool scalar = variant == kScalar;
      if (scalar) REQUIRE(setenv("PHOTONLOOM_SIMD", "scalar", 1) == 0);
      const Outcome o = run("render '" + source(scene) + "'" + arguments + (scalar ? "" : variant) +
                            " -o '" + scratch / "image.exr" + "' --json");
      unsetenv("PHOTONLOOM_SIMD");
      INFO(line << variant << "\n" << o.err);
      REQUIRE(o.status == 0);
      CHECK(nlohmann::json::parse(o.out)["pixels_sha256"] == expected);
    }
    scenes.insert(scene);
  }
  return scenes;
}

}  // namespace

TEST_CASE("golden images have their committed sums") {
  const std::string ways[] = {" --threads 1", " --threads 16", kScalar};
  const std::set<std::string> scenes = check_sums([&](size_t scene) {
    // Of two scenes all ways, and orders of the final gather too; of the others one way besides the
    // usual, in turn.
    std::vector<std::string> variants{"", ways[scene % 3]};
    if (scene < 2) {
      variants.assign(std::begin(ways), std::end(ways));
      for (const char* order : {"pixel", "direction_bins"})
        variants.push_back(std::string(" --set reorder.key=none --set frame.order=") + order);
      variants.emplace_back();
    }
    return variants;
  });
  for (const auto& entry : std::filesystem::directory_iterator(source("scenes"))) {
    if (entry.path().extension() != ".xml") continue;
    INFO(entry.path().filename() << ": no sum is listed");
    CHECK(scenes.count("scenes/" + entry.path().filename().string()) == 1);
  }
}

TEST_CASE("golden images have their committed sums with any SIMD level and number of threads",
          "[slow]") {
  check_sums([](size_t) {
    return std::vector<std::string>{" --threads 1", " --threads 16", kScalar};
  });
}
