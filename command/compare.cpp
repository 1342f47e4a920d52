// SPDX-License-Identifier: Apache-2.0
// photonloom compare A B: metrics, thresholds, error map.
#include <fmt/core.h>

#include <cmath>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "command/command.hpp"
#include "command/json_text.hpp"
#include "golden/image/metrics.hpp"
#include "golden/numeric/output_file.hpp"

namespace photonloom {
namespace {

struct MetricLimit {
  const char* option;
  const char* what;
  double (*value)(const Metrics&);
  bool at_least;
  double smallest, largest;  // that the value can be
  std::optional<double> given;
};
constexpr double kInfinity = std::numeric_limits<double>::infinity();

double mean_ratio_deviation(const Metrics& m) { return std::fabs(m.mean_ratio - 1); }
double mean_ratio_rgb_deviation(const Metrics& m) {
  double worst = 0;
  for (const double r : m.mean_ratio_rgb) worst = std::max(worst, std::fabs(r - 1));
  return worst;
}

struct CompareOptions {
  std::string a, b, layer, error_map;
  bool json = false, identical = false;
  std::vector<MetricLimit> limits = {
      {"--max-rmse", "rmse", [](const Metrics& m) { return m.rmse; }, false, 0, kInfinity, {}},
      {"--max-relmse",
       "relmse",
       [](const Metrics& m) { return m.relmse; },
       false,
       0,
       kInfinity,
       {}},
      {"--max-mape", "mape", [](const Metrics& m) { return m.mape; }, false, 0, kInfinity, {}},
      {"--max-mean-ratio", "|mean_ratio - 1|", mean_ratio_deviation, false, 0, kInfinity, {}},
      {"--max-mean-ratio-rgb",
       "largest |mean_ratio_rgb - 1|",
       mean_ratio_rgb_deviation,
       false,
       0,
       kInfinity,
       {}},
      {"--min-psnr",
       "psnr",
       [](const Metrics& m) { return m.psnr; },
       true,
       -kInfinity,
       kInfinity,
       {}},
      {"--max-flip", "flip", [](const Metrics& m) { return m.flip; }, false, 0, 1, {}},
  };
};

// JSON has no infinity: null.
nlohmann::ordered_json number(double x) {
  return std::isfinite(x) ? nlohmann::ordered_json(x) : nlohmann::ordered_json(nullptr);
}

void print(const CompareOptions& o, const Metrics& m) {
  if (o.json) {
    nlohmann::ordered_json j;
    j["a"] = o.a;
    j["b"] = o.b;
    if (!o.layer.empty()) j["layer"] = o.layer;
    j["rmse"] = number(m.rmse);
    j["relmse"] = number(m.relmse);
    j["mape"] = number(m.mape);
    j["mean_ratio"] = number(m.mean_ratio);
    j["mean_ratio_rgb"] = {number(m.mean_ratio_rgb[0]), number(m.mean_ratio_rgb[1]),
                           number(m.mean_ratio_rgb[2])};
    j["psnr"] = number(m.psnr);
    j["flip"] = number(m.flip);
    j["identical"] = m.identical;
    fmt::print("{}\n", json_text(j));
    return;
  }
  fmt::print("rmse            {:.6g}\n", m.rmse);
  fmt::print("relmse          {:.6g}\n", m.relmse);
  fmt::print("mape            {:.6g}\n", m.mape);
  fmt::print("mean_ratio      {:.6f}\n", m.mean_ratio);
  fmt::print("mean_ratio_rgb  {:.6f} {:.6f} {:.6f}\n", m.mean_ratio_rgb[0], m.mean_ratio_rgb[1],
             m.mean_ratio_rgb[2]);
  fmt::print("psnr            {:.2f} dB\n", m.psnr);
  fmt::print("flip            {:.6f}\n", m.flip);
  fmt::print("identical       {}\n", m.identical ? "yes" : "no");
}

// Black (0), red (1/3), yellow (2/3), white (1).
void write_heat(const std::vector<double>& values, int width, int height, const std::string& path) {
  std::vector<uint8_t> rgb;
  rgb.reserve(values.size() * 3);
  for (const double v : values)
    for (int c = 0; c < 3; ++c)
      rgb.push_back(static_cast<uint8_t>(std::lround(255 * std::clamp(3 * v - c, 0.0, 1.0))));
  write_png(rgb, width, height, path);
}

void compare(const CompareOptions& o) {
  if (!o.error_map.empty()) require_suffix("--error-map", o.error_map, ".png");
  check_outputs({o.error_map}, {o.a, o.b});
  const Image a = read_exr(o.a), b = read_exr(o.b);
  if (a.width != b.width || a.height != b.height)
    throw std::runtime_error(fmt::format("{} is {}x{}, but {} is {}x{}: expected the same size",
                                         o.a, a.width, a.height, o.b, b.width, b.height));
  const Planes pa = planes_of(a, o.layer, o.a), pb = planes_of(b, o.layer, o.b);
  std::vector<double> flip;
  const Metrics m = compare_planes(pa, pb, &flip);
  if (!o.error_map.empty()) write_heat(flip, a.width, a.height, o.error_map);
  print(o, m);
  std::string exceeded;
  for (const MetricLimit& limit : o.limits) {
    if (!limit.given) continue;
    const double value = limit.value(m);
    if (limit.at_least ? !(value >= *limit.given) : !(value <= *limit.given))
      exceeded +=
          fmt::format("{}{} is {:.6g}, {} {} allowed", exceeded.empty() ? "" : "; ", limit.what,
                      value, limit.at_least ? "at least" : "at most", *limit.given);
  }
  if (o.identical && !m.identical)
    exceeded += std::string(exceeded.empty() ? "" : "; ") + "the images are not identical";
  if (!exceeded.empty()) throw CheckFailed(fmt::format("{} against {}: {}", o.a, o.b, exceeded));
}

// A limit that no image can exceed, or each must, is a slip.
CLI::Validator limit_number(const MetricLimit& limit) {
  const double low = limit.smallest, high = limit.largest;
  const std::string expected = !std::isfinite(low) ? "a number"
                               : std::isfinite(high)
                                   ? fmt::format("a number from {} to {}", low, high)
                                   : fmt::format("a number of at least {}", low);
  return number_value(expected, [low, high](double x) { return x >= low && x <= high; });
}

void add_compare(CLI::App& app) {
  auto o = std::make_shared<CompareOptions>();
  CLI::App* c = app.add_subcommand("compare", "How far an EXR image is from another");
  c->footer(
      "A is judged, B is the reference; channels R, G, B, or those of --layer. n is pixels x 3.\n"
      "  rmse            sqrt(sum (a-b)^2 / n)\n"
      "  relmse          sum ((a-b)^2 / (b^2 + 0.01)) / n\n"
      "  mape            sum (|a-b| / (|b| + 0.01)) / n\n"
      "  mean_ratio      sum a / sum b, over all channels; mean_ratio_rgb for each\n"
      "  psnr            20 log10(largest b / rmse) in dB; null in JSON when infinite\n"
      "  flip            mean HDR-FLIP, 0 (no visible difference) to 1\n"
      "Sizes that differ and pixels that are not finite are errors. Exit status 1 when a limit is\n"
      "exceeded.\n\n"
      "Example: photonloom compare golden.exr path.exr --max-relmse 0.03 --error-map error.png");
  c->add_option("A", o->a, "Image to judge (EXR)")->required();
  c->add_option("B", o->b, "Reference image (EXR)")->required();
  c->add_option("--layer", o->layer,
                "Compare this layer: direct, caustic, indirect, emission, albedo, N, Z, ...");
  c->add_option("--error-map", o->error_map,
                "PNG of FLIP per pixel: black 0, red 1/3, yellow 2/3, white 1")
      ->type_name("FILE.png");
  c->add_flag("--json", o->json, "Print one JSON object");
  c->add_flag("--identical", o->identical, "Fail unless every value is the same");
  for (MetricLimit& limit : o->limits)
    c->add_option(limit.option, limit.given,
                  fmt::format("Fail unless {} is {} this", limit.what,
                              limit.at_least ? "at least" : "at most"))
        ->check(limit_number(limit))
        ->type_name("X");
  c->callback([o] { compare(*o); });
}

const Command compare_command(50, add_compare);

}  // namespace
}  // namespace photonloom
