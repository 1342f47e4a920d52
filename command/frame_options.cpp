// SPDX-License-Identifier: Apache-2.0
#include "command/frame_options.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>

#include "command/tell.hpp"
#include "golden/numeric/strict_size.hpp"
#include "golden/plan/plan_file.hpp"

namespace photonloom {
namespace {

// What the plan decides, so that it cannot be asked for beside --plan.
constexpr const char* kPlanned[] = {"--size", "--spp",    "--photons",      "--caustic-photons",
                                    "--k",    "--radius", "--format-error", "--gather-rays"};
// What the path tracer does not read.
constexpr const char* kPhotonOnly[] = {"--photons", "--caustic-photons", "--gather-rays",
                                       "--k",       "--radius",          "--format-error"};

// What a line of --set may not decide beside it. --radius is of both maps, and --set may make one
// of them another: what render advises where photons are short.
const Shortcut kShortcuts[] = {{"--size", {"frame.width", "frame.height"}},
                               {"--spp", {"frame.spp"}},
                               {"--photons", {"global.photons", "photons"}},
                               {"--caustic-photons", {"caustic.photons", "caustic_photons"}},
                               {"--gather-rays", {"frame.gather_rays"}},
                               {"--k", {"gather.k"}}};

// What a plan that is there already does not take: neither a scene nor another plan's lines.
constexpr const char* kDerivation[] = {"--plan",
                                       "--size",
                                       "--spp",
                                       "--photons",
                                       "--caustic-photons",
                                       "--gather-rays",
                                       "--k",
                                       "--radius",
                                       "--format-error",
                                       "--seed",
                                       "--define",
                                       "--load-photons",
                                       "--load-caustics"};

// Of a NAME=VALUE.
std::string set_name(const std::string& line) { return line.substr(0, line.find('=')); }

}  // namespace

bool is_plan(const std::string& path) { return std::filesystem::path(path).extension() == ".toml"; }

std::pair<int, int> parse_size(const std::string& text, const std::string& option) {
  if (const auto size = strict_size(text, 16384)) return *size;
  throw UsageError(
      fmt::format("{}: '{}', expected WIDTHxHEIGHT of 1 to 16384 pixels each", option, text));
}

CLI::Validator radius_number() {
  return number_value("a finite number of scene units of at least 0, 0 for none",
                      [](double radius) { return radius >= 0; });
}

void check_set_lines(const std::vector<std::string>& lines, SetLines names) {
  std::set<std::string> seen;
  for (const std::string& line : lines) {
    const std::string name = set_name(line);
    if (name.size() == line.size() ||
        (names == SetLines::kOfPlan && name.find('.') == std::string::npos))
      throw UsageError(fmt::format("--set: '{}', expected section.key=value", line));
    if (!seen.insert(name).second)
      throw UsageError(fmt::format("--set {}: {} is set twice", line, name));
  }
}

void check_set_values(const std::vector<std::string>& lines) {
  for (const std::string& line : lines) {
    Plan plan;
    as_usage("--set: ", [&] { set_plan_line(plan, line); });
  }
}

void refuse_decided(const std::vector<std::string>& lines, const Shortcut& shortcut) {
  for (const std::string& line : lines)
    for (const char* decided : shortcut.lines)
      if (set_name(line) == decided)
        throw UsageError(
            fmt::format("--set {}: {} is decided by {}", line, decided, shortcut.option));
}

std::vector<std::string> frame_inputs(const FrameRequest& request) {
  return {request.scene_file, request.plan_file, request.load_photons, request.load_caustics};
}

void FrameOptions::add_to(CLI::App& c) {
  command_ = &c;
  scene_.add_to(c);
  c.add_option(
       "--plan", request_.plan_file,
       "Use this plan.toml instead of deriving one; it then decides size, samples, photons, "
       "k and radius")
      ->type_name("FILE");
  c.add_option("--set", request_.set,
               "Change one line of the plan, e.g. photon.position_bits=12; may be repeated")
      ->type_name("LINE=VALUE")
      ->expected(1)
      ->take_all();
  c.add_option("--size", size_, "Pixels (default: the film's)")->type_name("WxH");
  c.add_option("--spp", request_.spp, "Samples per pixel (default: the scene's sampleCount, or 16)")
      ->check(CLI::Range(1, 1 << 20))
      ->type_name("N");
  c.add_option("--photons", request_.photons, "Photons stored in the global map (default 500000)")
      ->check(CLI::Range(uint64_t{1}, uint64_t{1} << 28))
      ->type_name("N");
  c.add_option("--caustic-photons", request_.caustic_photons,
               "Photons stored in the caustic map (default 500000)")
      ->check(CLI::Range(uint64_t{1}, uint64_t{1} << 28))
      ->type_name("N");
  c.add_option("--gather-rays", request_.gather_rays,
               "Final gather rays per sample (default: so that spp x rays = 256); 0: no indirect "
               "light on diffuse surfaces")
      ->check(CLI::Range(0, 65535))
      ->type_name("N");
  c.add_option("--k", request_.k, "Photons in an estimate (default 50)")
      ->check(CLI::Range(1, 256))
      ->type_name("N");
  c.add_option("--radius", request_.radius,
               "Maximum gather radius of both maps in scene units, 0 for none (default: a formula "
               "of k, photons and surface area, docs/plan.md)")
      ->check(radius_number())
      ->type_name("R");
  c.add_option("--format-error", request_.format_error,
               "Relative error that the number formats may add; chooses their widths")
      ->check(number_value("a number between 0 and 1",
                           [](double error) { return error > 0 && error < 1; }))
      ->type_name("E");
  add_seed_option(c, request_.seed, "Of all randomness (default 1)");
  c.add_option(
       "--load-photons", request_.load_photons,
       "Global photons from a file that `photonloom photons` wrote, all of them; --photons beside "
       "it must be their number")
      ->type_name("PLY");
  c.add_option(
       "--load-caustics", request_.load_caustics,
       "Caustic photons from a file that `photonloom photons --caustic` wrote, all of them; "
       "--caustic-photons beside it must be their number")
      ->type_name("PLY");
}

FrameRequest FrameOptions::request(SetLines lines) const {
  FrameRequest request = request_;
  if (!request.plan_file.empty())
    for (const char* option : kPlanned)
      if (command_->count(option) > 0)
        throw UsageError(fmt::format(
            "{}: the plan given by --plan decides it; change its line with --set", option));
  check_set_lines(request.set, lines);
  for (const Shortcut& shortcut : kShortcuts)
    if (command_->count(shortcut.option) > 0) refuse_decided(request.set, shortcut);
  if (lines == SetLines::kOfPlan) check_set_values(request.set);
  if (!size_.empty()) request.size = parse_size(size_);
  request.scene_file = scene_.path();
  request.parameters = scene_.parameters();
  return request;
}

void FrameOptions::refuse_derivation(const std::string& plan_file) const {
  for (const char* option : kDerivation)
    if (command_->count(option) > 0)
      throw UsageError(
          fmt::format("{}: {} already is a plan; change its lines with --set", option, plan_file));
}

void FrameOptions::refuse_all(const std::string& why) const {
  if (command_->count("--set") > 0) throw UsageError("--set: " + why);
  for (const char* option : kDerivation)
    if (command_->count(option) > 0) throw UsageError(fmt::format("{}: {}", option, why));
}

bool FrameOptions::has_seed() const { return command_->count("--seed") > 0; }

std::vector<std::string> FrameOptions::photon_options() const {
  std::vector<std::string> given;
  for (const char* option : kPhotonOnly)
    if (command_->count(option) > 0) given.emplace_back(option);
  return given;
}

void describe_frame(Image& image, const PreparedFrame& frame, const FrameRequest& request,
                    const std::string& arithmetic) {
  const Plan& plan = frame.plan;
  auto& m = image.metadata;
  m["scene"] = std::filesystem::path(request.scene_file).stem().string();
  m["sceneHash"] = fmt::format("{:016x}", frame.world->scene().hash);
  m["seed"] = fmt::format("{}", request.seed);
  m["integrator"] = "photonmap";
  m["arithmetic"] = arithmetic;
  m["photons"] = fmt::format("{}", frame.global.count);
  m["causticPhotons"] = fmt::format("{}", frame.caustic.count);
  m["k"] = fmt::format("{}", plan.k);
  m["radius"] = fmt::format("{}", plan.global.radius);
  m["causticRadius"] = fmt::format("{}", plan.caustic.radius);
  m["gatherRays"] = fmt::format("{}", plan.gather_rays);
  m["spp"] = fmt::format("{}", plan.spp);
  m["planHash"] = plan_hash_text(plan);
}

GatherDiagnosis diagnose_into(Image& image, const GatherWatch& watch, const PreparedFrame& frame,
                              const FrameRequest& request) {
  // The seed of photons from a file is not known here.
  const GatherDiagnosis diagnosis = diagnose_gathers(
      watch, frame,
      request.load_photons.empty() ? std::optional<uint64_t>(request.seed) : std::nullopt);
  diagnosis.add_layers(image);
  return diagnosis;
}

nlohmann::ordered_json diagnosis_json(const GatherDiagnosis& diagnosis) {
  nlohmann::ordered_json json;
  for (const bool is_caustic : {false, true}) {
    const GatherTally& t = diagnosis.tally[is_caustic];
    json[is_caustic ? "caustic" : "global"] = {
        {"gathers", t.gathers}, {"no_photon", t.none}, {"fewer_than_k", t.few}};
  }
  json["regions"] = nlohmann::ordered_json::array();
  for (const ShortRegion& r : diagnosis.regions) {
    nlohmann::ordered_json region = {
        {"cause", shortage_name(r.shortage)}, {"pixels", r.pixels}, {"found", r.found}};
    if (r.shortage == Shortage::kStarvedLight) {
      region["light"] = r.light;
      region["light_photons"] = r.light_photons;
    }
    region["advice"] = {{"photons", r.advice.photons},
                        {"radius", r.advice.radius},
                        {"k", r.advice.k},
                        {"options", r.advice.options}};
    region["message"] = r.message;
    json["regions"].push_back(region);
  }
  return json;
}

std::vector<std::string> diagnosis_messages(const GatherDiagnosis& diagnosis,
                                            const FrameRequest& request) {
  std::vector<std::string> messages;
  for (const ShortRegion& r : diagnosis.regions)
    messages.push_back(r.message +
                       (!request.plan_file.empty() && r.advice.options.starts_with("--photons")
                            ? " (--photons in a plan made anew: that of --plan has its own)"
                            : ""));
  return messages;
}

nlohmann::ordered_json range_counts_json(const FrameCounts& c) {
  nlohmann::ordered_json json = {{"clamped", c.clamped},
                                 {"cache_full", c.cache_full},
                                 {"saturated_weights", c.shader.weights},
                                 {"saturated_direct", c.shader.direct},
                                 {"not_finite", c.shader.not_finite}};
  ClampCounts::visit([&](const char* name, auto member) { json[name] = c.clamps.*member; });
  return json;
}

nlohmann::ordered_json counts_json(const FrameCounts& c) {
  nlohmann::ordered_json json = {{"camera_samples", c.camera_samples},
                                 {"caustic_queries", c.caustic_queries},
                                 {"table_gathers", c.table_gathers},
                                 {"directions", c.directions},
                                 {"below_horizon", c.below_horizon},
                                 {"final_gathers", c.final_gathers},
                                 {"full", c.full}};
  json.update(range_counts_json(c));
  return json;
}

std::string range_counts_text(const FrameCounts& counts) {
  std::string text;
  const auto json = range_counts_json(counts);
  for (const auto& [name, n] : json.items())
    if (n != 0) text += fmt::format("{}{} {}", text.empty() ? "" : ", ", name, n.get<uint64_t>());
  return text.empty() ? "none" : text;
}

std::vector<std::string> count_messages(const FrameCounts& counts) {
  std::vector<std::string> messages;
  if (counts.shader.weights || counts.shader.direct)
    messages.push_back(
        fmt::format("{} weights and {} values of direct light exceed the pixel's integer bits and "
                    "were taken as the largest that fit",
                    counts.shader.weights, counts.shader.direct));
  if (counts.clamps.positions)
    messages.push_back(
        fmt::format("{} queries lie outside of the cube and were asked from its nearest unit",
                    counts.clamps.positions));
  if (counts.clamps.gradients)
    messages.push_back(
        fmt::format("{} numbers of records' gradients exceed 31 bits and were taken as the largest "
                    "that fit",
                    counts.clamps.gradients));
  if (counts.shader.not_finite)
    messages.push_back(fmt::format("{} values of light were no finite number and count as 0",
                                   counts.shader.not_finite));
  return messages;
}

nlohmann::ordered_json packed_json(const PreparedFrame& frame) {
  return {{"zeroed_photons", frame.global_counts.zeroed + frame.caustic_counts.zeroed},
          {"saturated_photons", frame.global_counts.saturated + frame.caustic_counts.saturated},
          {"outside_photons", frame.global_counts.outside + frame.caustic_counts.outside}};
}

void print_warnings(const std::vector<std::string>& warnings) {
  for (const std::string& w : warnings) tell("photonloom: warning: {}\n", w);
}

}  // namespace photonloom
