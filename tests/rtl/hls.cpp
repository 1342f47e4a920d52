// SPDX-License-Identifier: Apache-2.0
// The HLS kernels' native runs: a kernel that waits forever says for what, and a wrong one is
// caught.
#include <cstdlib>
#include <filesystem>

#include "tests/catch.hpp"
#include "tests/command/run.hpp"
#include "verilator_tb/unit/backends.hpp"
#include "verilator_tb/unit/compare_units.hpp"
#include "verilator_tb/unit/drawn_run.hpp"

using namespace photonloom;
using namespace photonloom::test;

namespace {

// A copy of the kernels with `right` replaced by `wrong` in one file; in use while it lives.
struct Planted {
  Planted(const std::string& file, const std::string& right, const std::string& wrong) {
    std::filesystem::copy(source("hls_kernels"), scratch / "hls_kernels",
                          std::filesystem::copy_options::recursive);
    const std::string path = scratch / ("hls_kernels/" + file);
    std::string text = read_file(path);
    REQUIRE(text.find(right) != std::string::npos);
    text.replace(text.find(right), right.size(), wrong);
    write_file(path, text);
    setenv("PHOTONLOOM_HLS", (scratch / "hls_kernels").c_str(), 1);
  }
  ~Planted() { unsetenv("PHOTONLOOM_HLS"); }
  Scratch scratch;
};

Plan sampler_plan() {
  Plan plan;
  plan.cell_bits = 2;
  plan.k = 4;
  return plan;
}

// Two tables and a request each.
std::vector<SamplerInput> tables() {
  std::vector<SamplerInput> in;
  for (uint32_t t = 0; t < 2; ++t) {
    SamplerInput p{};
    p.normal = {100 + t, 30};
    in.push_back(p);
    p = {};
    p.kind = 1;
    p.mantissa = {1, 2, 3};
    p.direction = {40 * t, 200};
    in.push_back(p);
    p = {};
    p.kind = 2;
    p.u = 0x12345678u << t;
    in.push_back(p);
  }
  return in;
}

RunOptions options() {
  RunOptions o;
  o.kind = ModelKind::kHls;
  o.work_dir = "cosim";
  return o;
}

std::string problem_of(CdfSampler& sampler) {
  std::vector<Sample> out;
  try {
    sampler.process(tables(), out);
  } catch (const RigError& error) {
    return error.what();
  }
  return "none";
}

}  // namespace

TEST_CASE("the sampler's streams are as deep as they must be") {
  const Plan plan = sampler_plan();
  const auto kernel = make_rtl_cdf_sampler(plan, options());
  const auto golden = make_golden_cdf_sampler(plan);
  std::vector<Sample> out, expected;
  kernel->process(tables(), out);
  golden->process(tables(), expected);
  CHECK(out == expected);
  CHECK(out.size() == 2);
  CHECK(kernel->cycles() > 2 * 16);
}

TEST_CASE("a depth one too small is found and named") {
  const Planted planted("cdf_sampler/cdf_sampler.hpp", "HLS_STREAM(T, Cosine, cosines, kCells)",
                        "HLS_STREAM(T, Cosine, cosines, kCells - 1)");
  for (uint64_t seed = 1; seed < 6; ++seed) {
    RunOptions o = options();
    o.seed = seed;
    const auto kernel = make_rtl_cdf_sampler(sampler_plan(), o);
    const std::string problem = problem_of(*kernel);
    INFO(problem);
    CHECK_THAT(problem, ContainsSubstring("unit cdf_sampler: stuck: stream ") &&
                            ContainsSubstring("cosines full (process cosine)") &&
                            ContainsSubstring("cosine_totals empty (process weigh)"));
  }
}

TEST_CASE("the gatherer answers queries while at least four are in flight") {
  Plan plan;
  plan.global.present = true;
  plan.global.photons = 500;
  plan.global.r2_max = uint64_t{1} << 24;
  plan.k = 8;
  plan.contexts = 1;
  const std::type_identity<PhotonGatherer> gatherer;
  const DrawnRun run = run_drawn(gatherer, plan, options());
  INFO(run.in_flight << " in flight");
  CHECK(run.in_flight >= 4);

  const Planted planted("photon_gatherer/timing.hpp", "kLeastContexts = 4", "kLeastContexts = 2");
  const DrawnRun fewer = run_drawn(gatherer, plan, options());
  INFO(fewer.in_flight << " in flight with two contexts");
  CHECK(fewer.in_flight < 4);
}

TEST_CASE("a packet that nobody reads is found") {
  const Planted planted("cdf_sampler/cdf_sampler.hpp", "commands.write(end);",
                        "commands.write(end);\n    commands.write(end);");
  const auto kernel = make_rtl_cdf_sampler(sampler_plan(), options());
  CHECK_THAT(problem_of(*kernel), ContainsSubstring("stream commands: ") &&
                                      ContainsSubstring("1 packets were never read"));
}

TEST_CASE("a planted fault diverges, and the report says where") {
  const Planted planted("cdf_sampler/cdf_sampler.hpp", "sample.weight = high - low;",
                        "sample.weight = high - low + 1;");
  const Plan plan = sampler_plan();
  const auto golden = make_golden_cdf_sampler(plan);
  const auto kernel = make_rtl_cdf_sampler(plan, options());
  CompareContext context;
  context.unit = "cdf_sampler";
  context.backend = "hls";
  context.waveform.clear();
  const auto both = compare_units(plan, context, *golden, *kernel);
  std::vector<Sample> out;
  try {
    both->process(tables(), out);
    FAIL("no divergence");
  } catch (const Divergence& divergence) {
    CHECK_THAT(divergence.what(),
               ContainsSubstring("cdf_sampler, stream out: packet 0 differs from golden") &&
                   ContainsSubstring("* weight"));
  }
}
