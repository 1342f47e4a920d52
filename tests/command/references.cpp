// SPDX-License-Identifier: Apache-2.0
// Golden photon mapping against the committed path traced images of scenes/references, with limits:
// noise in single pixels, bias in the means of the image and of each layer.
#include <fmt/core.h>

#include "tests/catch.hpp"
#include "tests/command/run.hpp"

using namespace photonloom::test;

TEST_CASE("golden images are those of scenes/references: means within 1 %, of layers within 2 %") {
  const Scratch scratch;
  int references = 0;
  for (const auto& entry : std::filesystem::directory_iterator(source("scenes/references"))) {
    const std::string reference = entry.path().string(), name = entry.path().stem().string();
    // NAME.WIDTHxHEIGHT.*.exr are those of sweeps, whose own tests read them (docs/sweep.md).
    if (name.find('.') != std::string::npos) continue;
    ++references;
    const std::string image = scratch / "image.exr";
    const Outcome rendered = run(
        fmt::format("render '{}' --size 256x256 --spp 2 --gather-rays 8 --k 50 --photons 100000 "
                    "--caustic-photons 100000 -o '{}'",
                    source("scenes/" + name + ".xml"), image));
    INFO(name << "\n" << rendered.err);
    REQUIRE(rendered.status == 0);
    const auto compared = [&](const std::string& limits) {
      const Outcome o = run(fmt::format("compare '{}' '{}' {}", image, reference, limits));
      INFO(limits << "\n" << o.out << o.err);
      CHECK(o.status == 0);
    };
    // Two samples of eight gather rays are noisier than the demo's sixteen of sixteen.
    compared("--max-relmse 0.045 --max-flip 0.13 --max-mean-ratio 0.01 --max-mean-ratio-rgb 0.01");
    for (const char* layer : {"direct", "caustic", "indirect", "emission"})
      compared(fmt::format("--layer {} --max-mean-ratio 0.02", layer));
  }
  CHECK(references > 0);
}
