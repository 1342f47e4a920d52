// SPDX-License-Identifier: Apache-2.0
// photonloom precision SCENE... -o table.csv: what number formats cost.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>

#include "command/command.hpp"
#include "command/console.hpp"
#include "command/frame_options.hpp"
#include "golden/image/metrics.hpp"
#include "golden/numeric/output_file.hpp"
#include "golden/numeric/text.hpp"
#include "golden/pipeline/prepare.hpp"

namespace photonloom {
namespace {

struct PrecisionOptions {
  std::vector<std::string> scenes;
  std::string output, size = "64x64";
  FrameRequest request;
  ThreadsOption threads;
};

// One factor: a line of the plan and what it is set to.
struct Factor {
  const char* name;
  std::vector<const char*> lines;  // all set to the value
  int smallest, largest, base;
};

const Factor kFactors[] = {
    {"position", {"photon.position_bits"}, 10, 20, 16},
    {"mantissa", {"photon.mantissa_bits"}, 5, 12, 9},
    {"direction", {"photon.direction_bits", "gather.normal_bits"}, 5, 12, 8}};

struct Cost {
  double relmse, bias, worst;
  uint64_t zeroed, saturated, photons;
  double unit_in_radius;  // position unit over the smallest radius
};

// Golden against reference with the same plan: same photons, queries and directions.
Cost cost_of(const FrameRequest& request) {
  const PreparedFrame frame = prepare_frame(request, Arithmetic::kReference, nullptr);
  FrameCounts counts;
  FrameUnits units = make_golden_units(frame.plan);
  const Image golden = render_frame(frame.input(Arithmetic::kGolden), units, counts);
  FrameUnits again = make_golden_units(frame.plan);
  const Image reference = render_frame(frame.input(Arithmetic::kReference), again, counts);
  const Planes a = planes_of(golden, "", "golden"), b = planes_of(reference, "", "reference");
  double difference = 0, sum_a = 0, sum_b = 0, worst = 0;
  size_t n = 0;
  for (size_t c = 0; c < 3; ++c)
    for (size_t i = 0; i < a.c[c].size(); ++i, ++n) {
      const double d = a.c[c][i] - b.c[c][i];
      difference += d * d / (b.c[c][i] * b.c[c][i] + 0.01);
      sum_a += a.c[c][i];
      sum_b += b.c[c][i];
      worst = std::max(worst, std::fabs(d));
    }
  double radius = 0;
  for (const MapPlan* m : {&frame.plan.global, &frame.plan.caustic})
    if (m->present && (radius == 0 || m->radius < radius)) radius = m->radius;
  return {difference / static_cast<double>(n),
          sum_a / sum_b - 1,
          worst / (sum_b / static_cast<double>(n)),
          frame.global_counts.zeroed + frame.caustic_counts.zeroed,
          frame.global_counts.saturated + frame.caustic_counts.saturated,
          frame.global.count + frame.caustic.count,
          radius > 0 ? frame.plan.position_unit() / radius : 0};
}

void precision(const PrecisionOptions& o) {
  o.threads.apply();
  FrameRequest request = o.request;
  request.size = parse_size(o.size);
  request.outputs = {o.output};
  check_outputs(request.outputs, o.scenes);
  uint64_t runs = 0;
  for (const Factor& f : kFactors) runs += static_cast<uint64_t>(f.largest - f.smallest + 1);
  ConsoleProgress progress;
  std::string table =
      "scene,factor,bits,relmse,bias,worst_pixel,zeroed_photons,saturated_photons,photons,"
      "unit_over_radius\n";
  for (const std::string& scene : o.scenes) {
    const std::string name = std::filesystem::path(scene).stem().string();
    const ProgressPhase phase(&progress, name, runs, "plans");
    for (const Factor& factor : kFactors)
      for (int bits = factor.smallest; bits <= factor.largest; ++bits) {
        request.scene_file = scene;
        request.set.clear();
        for (const Factor& f : kFactors)
          for (const char* line : f.lines)
            request.set.push_back(fmt::format("{}={}", line, &f == &factor ? bits : f.base));
        request.set.push_back("photon.photon_bytes=32");  // room for the widest of them
        const Cost c = cost_of(request);
        table += fmt::format("{},{},{},{:.6g},{:.6g},{:.6g},{},{},{},{:.6g}\n", csv_field(name),
                             factor.name, bits, c.relmse, c.bias, c.worst, c.zeroed, c.saturated,
                             c.photons, c.unit_in_radius);
        phase.advance(1);
      }
  }
  write_file(o.output, table);
  fmt::print("wrote {}\n", o.output);
}

void add_precision(CLI::App& app) {
  auto o = std::make_shared<PrecisionOptions>();
  o->request.photons = 100000;
  o->request.caustic_photons = 100000;
  o->request.spp = 4;
  o->request.gather_rays = 16;
  CLI::App* c =
      app.add_subcommand("precision", "What number formats cost: golden against reference");
  c->footer(
      "From a base of 16-bit positions, 9-bit mantissas and 2 x 8-bit directions, one factor at a\n"
      "time: positions of 10 to 20 bits, mantissas of 5 to 12, directions and normals of 2 x 5 to\n"
      "2 x 12. Each plan is rendered in both arithmetics, which see the same photons, queries and\n"
      "directions. Columns of the CSV: relmse as in `compare`; bias, the ratio of the images' "
      "means\n"
      "minus 1; worst_pixel, the largest difference of a pixel's channel over the mean of the\n"
      "reference; photons whose power became zero or was clipped; the position unit over the\n"
      "smallest gather radius. docs/precision.md is made from it by `make precision`.\n\n"
      "Example: photonloom precision scenes/cornell_balls.xml scenes/cornell_glossy.xml -o p.csv");
  c->add_option("SCENE", o->scenes, "Scene files (Mitsuba XML)")->required();
  c->add_option("-o,--output", o->output, "CSV file to write")->required()->type_name("FILE");
  c->add_option("--size", o->size, "Pixels")->capture_default_str()->type_name("WxH");
  c->add_option("--spp", o->request.spp, "Samples per pixel (default 4)")
      ->check(CLI::Range(1, 1 << 20))
      ->type_name("N");
  c->add_option("--photons", o->request.photons,
                "Photons stored in the global map (default 100000)")
      ->check(CLI::Range(uint64_t{1}, uint64_t{1} << 28))
      ->type_name("N");
  c->add_option("--caustic-photons", o->request.caustic_photons,
                "Photons stored in the caustic map (default 100000)")
      ->check(CLI::Range(uint64_t{1}, uint64_t{1} << 28))
      ->type_name("N");
  add_seed_option(*c, o->request.seed, "Of all randomness (default 1)");
  o->threads.add_to(*c);
  c->callback([o] { precision(*o); });
}

const Command precision_command(60, add_precision);

}  // namespace
}  // namespace photonloom
