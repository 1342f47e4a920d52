// SPDX-License-Identifier: Apache-2.0
// photonloom with units as HLS kernels: frames, mixed frames, and what goes wrong.
#include <fmt/core.h>

#include <nlohmann/json.hpp>

#include "tests/catch.hpp"
#include "tests/command/run.hpp"

using namespace photonloom;
using namespace photonloom::test;

namespace {

std::string hls_cosim(const Scratch& scratch, const std::string& backends) {
  return fmt::format(
      "cosim {} --size 8x8 --spp 1 --gather-rays 6 --k 8 --photons 2000 --caustic-photons 800 "
      "--set gatherer.cache_bytes=2048 --work cosim -o {} --backend {}",
      source("scenes/cornell_balls.xml"), scratch / "out", backends);
}

}  // namespace

TEST_CASE("all units as HLS kernels give golden's packets and image") {
  const Scratch scratch;
  const Outcome o = run(
      hls_cosim(scratch, "photon_gatherer=hls,reorder_buffer=hls,cdf_sampler=hls --stall bursts"));
  INFO(o.out << o.err);
  REQUIRE(o.status == 0);
  CHECK_THAT(o.out, ContainsSubstring("golden == hls: ") &&
                        ContainsSubstring("image bytes of golden and hls are identical"));
  const auto summary = nlohmann::json::parse(read_file(scratch / "out/summary.json"));
  for (const char* unit : {"photon_gatherer", "reorder_buffer", "cdf_sampler"}) {
    INFO(unit);
    CHECK(summary["units"][unit]["packets"] > 50);
    CHECK(summary["units"][unit]["bypassed"] == 0);
    CHECK(summary["units"][unit]["counters"]["cycles"] > 50);
  }
  CHECK(read_file(scratch / "out/hls.exr") == read_file(scratch / "out/golden.exr"));
}

TEST_CASE("units as HLS kernel, RTL and golden in one frame", "[slow]") {
  const Scratch scratch;
  for (const char* backends : {"photon_gatherer=hls,reorder_buffer=rtl,cdf_sampler=golden",
                               "photon_gatherer=golden,reorder_buffer=hls,cdf_sampler=rtl",
                               "photon_gatherer=rtl,reorder_buffer=golden,cdf_sampler=hls"}) {
    const Outcome o = run(hls_cosim(scratch, backends));
    INFO(backends << o.out << o.err);
    REQUIRE(o.status == 0);
    CHECK_THAT(o.out, ContainsSubstring("image bytes of golden and hardware are identical"));
  }
}

TEST_CASE("an HLS kernel writes no waveform") {
  const Scratch scratch;
  const Outcome o = run(hls_cosim(scratch, "reorder_buffer=hls --wave " + (scratch / "wave.fst")));
  INFO(o.out << o.err);
  CHECK(o.status != 0);
  CHECK(o.one_error_line());
}
