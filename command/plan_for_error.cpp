// SPDX-License-Identifier: Apache-2.0
#include "command/plan_for_error.hpp"

#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>

#include "command/console.hpp"
#include "command/frame_options.hpp"
#include "command/json_text.hpp"
#include "command/tell.hpp"
#include "golden/numeric/output_file.hpp"
#include "study/plan_search.hpp"
#include "study/point_plan.hpp"
#include "study/study_file.hpp"

namespace photonloom {
namespace {

using Json = nlohmann::ordered_json;

// What goes with --error or --explain alone.
constexpr const char* kSearchOptions[] = {"--advise", "--metric", "--minimise",
                                          "--check",  "--work",   "--measure-size",
                                          "--seeds",  "--points", "--reference-spp"};

// The lines that the user fixed, as a study's [base].
LineValues asked_lines(const FrameRequest& r) {
  LineValues lines;
  const auto add = [&](const char* name, const auto& value) {
    if (value) lines.emplace_back(name, fmt::format("{}", *value));
  };
  add("photons", r.photons);
  add("caustic_photons", r.caustic_photons);
  add("frame.spp", r.spp);
  add("frame.gather_rays", r.gather_rays);
  add("gather.k", r.k);
  add("global.radius", r.radius);
  add("caustic.radius", r.radius);
  for (const std::string& line : r.set) {
    const size_t at = line.find('=');
    // A study's '+' would hide the line from what the planner leaves alone.
    if (at == std::string::npos || line.find('+') < at)
      throw UsageError(fmt::format("--set: '{}', expected section.key=value", line));
    lines.emplace_back(line.substr(0, at), line.substr(at + 1));
    const auto& [name, value] = lines.back();
    if (const std::string problem = line_problem(name, value, "--size"); !problem.empty())
      throw UsageError("--set: " + problem);
  }
  return lines;
}

// The plan's lines that a line of a study decides.
std::vector<std::string> decided_lines(const std::string& line) {
  if (line == "photons") return {"global.photons"};
  if (line == "caustic_photons") return {"caustic.photons"};
  if (line == "radius_scale") return {"global.radius", "caustic.radius"};
  if (line == "packed") return {"photon.photon_bytes"};
  return {line};
}

// "0.005" or "1.5x"; nothing for an empty text.
std::optional<ErrorLimit> parse_limit(const std::string& text) {
  if (text.empty()) return std::nullopt;
  ErrorLimit limit;
  limit.is_factor = text.back() == 'x';
  const char* const end = text.data() + text.size() - (limit.is_factor ? 1 : 0);
  const auto error = strict_number<double>({text.data(), end});
  if (!error || *error <= 0)
    throw UsageError(fmt::format(
        "--error: '{}', expected a number above 0, or one with an x for so many times the default "
        "plan's error",
        text));
  limit.error = *error;
  return limit;
}

std::string row(const PlanSearch& search, const std::string& name, const MeasuredPlan& m) {
  const double predicted = search.objective(m.predicted_cost);
  const std::string cost_then = predicted > 0 ? fmt::format("{:.1f}", predicted) : "-";
  const std::string error_then =
      m.predicted_error > 0 ? fmt::format("{:.5f}", m.predicted_error) : "-";
  // A frame may ask for no gathers.
  const bool gathers = std::isfinite(m.cost.cycles);
  const std::string cycles = gathers ? fmt::format("{:.1f}", m.cost.cycles) : "-";
  const std::string bytes = gathers ? fmt::format("{:.0f}", m.cost.bytes) : "-";
  const std::string beyond =
      m.bound_beyond_limit ? fmt::format("{:.5f}", *m.bound_beyond_limit) : "-";
  return fmt::format(
      "  {:<10} {:>8.5f} ±{:>8.5f} {:>8.5f} {:>10} {:>9} {:>7.4f} {:>7} {:>7} {:>7.0f} "
      "{:>7.0f} {:>9}  {}\n",
      name, m.error.mean, m.error.error(), m.error.bound(), beyond, error_then, m.flip, cycles,
      bytes, m.cost.gatherer_lut, m.cost.lut, cost_then, lines_text(m.lines));
}

std::string header() {
  return fmt::format(
      "  {:<10} {:>8} {:>9} {:>8} {:>10} {:>9} {:>7} {:>7} {:>7} {:>7} {:>7} {:>9}  {}\n", "plan",
      "error", "", "a run <", "beyond E <", "predicted", "FLIP", "cycles", "bytes", "LUT-eq",
      "all LUT", "predicted", "lines");
}

Json measured_json(const MeasuredPlan& m) {
  Json j;
  j["lines"] = Json::object();
  for (const auto& [name, value] : m.lines) j["lines"][name] = value;
  j["error"] = m.error.mean;
  j["standard_error"] = m.error.error();
  j["from_seeds"] = m.error.seed_error;
  j["from_pixels"] = m.error.pixel_error;
  j["bound_of_a_run"] = m.error.bound();
  if (m.bound_beyond_limit) j["bound_beyond_limit"] = *m.bound_beyond_limit;
  j["seeds"] = m.error.seeds;
  j["predicted_error"] = m.predicted_error > 0 ? Json(m.predicted_error) : Json();
  j["relmse"] = m.relmse;
  j["flip"] = m.flip;
  j["cycles"] = m.cost.cycles;
  j["bytes"] = m.cost.bytes;
  j["luts"] = m.cost.gatherer_lut;
  j["all_luts"] = m.cost.lut;
  return j;
}

// Why a measured plan is not the one.
std::string why_it_lost(const PlanSearch& search, const MeasuredPlan& m, const MeasuredPlan& best,
                        double limit) {
  const double more = search.objective(m.cost) / search.objective(best.cost) - 1;
  if (m.error.mean > limit)
    return fmt::format("its error is {:.1f} % above the limit", 100 * (m.error.mean / limit - 1));
  if (more < 0 && *m.bound_beyond_limit > 0)
    return fmt::format("{:.1f} % cheaper, but a run of it may be {:.5f} above the limit",
                       -100 * more, *m.bound_beyond_limit);
  if (more < 0)
    return fmt::format("{:.1f} % cheaper, too little to measure it with all seeds", -100 * more);
  return fmt::format("costs {:.1f} % more", 100 * more);
}

}  // namespace

void PlanForError::add_to(CLI::App& c) {
  command_ = &c;
  const char* const group = "For a visible error";
  c.add_option("--error", error_,
               "Visible error that one run of the frame may have against path tracing: search for "
               "the cheapest plan that keeps it (docs/planner.md); 1.5x: so many times the default "
               "plan's")
      ->type_name("E")
      ->group(group);
  c.add_option("--metric", metric_,
               "What --error is of: relmse (default) or flip, the mean HDR-FLIP")
      ->check(CLI::IsMember({"relmse", "flip"}))
      ->type_name("METRIC")
      ->group(group);
  c.add_option("--minimise", minimise_,
               "cycles a gather (default), luts of the gatherer, or bytes read a gather")
      ->check(CLI::IsMember({"cycles", "luts", "bytes"}))
      ->type_name("COST")
      ->group(group);
  c.add_option("--board", board_,
               "A board of fpga/boards that the plan must fit; without --error: for the fastest "
               "gathers that it has room for")
      ->type_name("BOARD")
      ->group(group);
  c.add_option("--explain", explain_,
               "Print error and cost over values of this line of the plan, around the plan that is "
               "found, without --error around the default one; photons, caustic_photons and "
               "radius_scale too")
      ->type_name("LINE")
      ->group(group);
  c.add_flag("--advise", advise_,
             "Print how error and cost go with photons, k and radius around the plan")
      ->group(group);
  add_seed_option(
      c, check_,
      "Also run the whole frame with this seed and tell its error; exit status 1 if that is above "
      "E. Its references have twice the paths of those of the measured pixels, spread over the "
      "frame, at least 16 samples a pixel",
      "--check")
      ->group(group);
  c.add_option("--work", work_,
               "Folder of references and results, to go on with (default build/plan)")
      ->type_name("DIR")
      ->group(group);
  c.add_option("--measure-size", measured_size_,
               "Pixels measured, one of each of so many equal parts of the frame (default 64x64)")
      ->type_name("WxH")
      ->group(group);
  c.add_option("--seeds", seeds_, "Seeds that confirm a plan (default 6)")
      ->check(CLI::Range(2, 64))
      ->type_name("N")
      ->group(group);
  c.add_option("--points", points_,
               "Plans that the search measures at most, the default one among them (default 24); "
               "those of --advise and --explain come on top, and two where nothing meets E")
      ->check(CLI::Range(1, 1000))
      ->type_name("N")
      ->group(group);
  c.add_option("--reference-spp", reference_spp_,
               "Samples per pixel of each of the two references of the measured pixels (default "
               "2048)")
      ->check(CLI::Range(1, 1 << 20))
      ->type_name("N")
      ->group(group);
}

bool PlanForError::wanted() const { return !error_.empty() || !explain_.empty(); }

void PlanForError::refuse_alone() const {
  for (const char* option : kSearchOptions)
    if (command_->count(option) > 0) throw UsageError(fmt::format("{}: goes with --error", option));
}

void PlanForError::run(const FrameRequest& request, const std::string& output, bool json,
                       int workers, const std::function<void(const Plan&)>& describe) const {
  const std::optional<ErrorLimit> asked = parse_limit(error_);
  if (!asked) {
    if (advise_) throw UsageError("--advise: goes with --error");
    if (check_) throw UsageError("--check: goes with --error");
    if (!output.empty()) throw UsageError("--explain: writes no plan without --error; no -o");
  }
  const char* const option = asked ? "--error" : "--explain";
  if (request.format_error)
    throw UsageError(
        fmt::format("--format-error: {} chooses the formats; give one of them", option));
  if (!request.plan_file.empty() || is_plan(request.scene_file))
    throw UsageError(fmt::format("{}: starts from a scene, not from a plan", option));
  if (!request.load_photons.empty() || !request.load_caustics.empty())
    throw UsageError(
        fmt::format("--load-photons, --load-caustics: {} measures with photons of several seeds, "
                    "which it traces",
                    option));
  if (asked && output.empty() && !json)
    throw UsageError("a scene's plan needs -o FILE (- for standard output)");

  // Before anything is measured.
  if (!explain_.empty()) as_usage("", [&] { check_curve_line(explain_); });

  ConsoleProgress progress;
  PlanSearchRequest r;
  r.scene_file = request.scene_file;
  r.parameters = request.parameters;
  r.size = request.size;
  if (!measured_size_.empty())
    std::tie(r.measured_width, r.measured_height) = parse_size(measured_size_, "--measure-size");
  r.asked = asked_lines(request);
  r.flip = metric_ == "flip";
  if (r.flip) {
    if (!measured_size_.empty())
      throw UsageError(
          "--measure-size: HDR-FLIP looks at a pixel's neighbours, so --metric flip measures all "
          "pixels of the frame; expected a smaller --size instead");
    r.measured_width = r.measured_height = std::numeric_limits<int>::max();
  }
  r.objective = minimise_ == "cycles" ? PlanObjective::kCycles
                : minimise_ == "luts" ? PlanObjective::kLuts
                                      : PlanObjective::kBytes;
  r.board = board_;
  const uint64_t last = std::numeric_limits<uint64_t>::max() - static_cast<uint64_t>(seeds_ - 1);
  if (request.seed > last)
    throw UsageError(fmt::format(
        "--seed: {} is the first of {} seeds (--seeds), expected an integer from 0 to {}",
        request.seed, seeds_, last));
  r.seed = request.seed;
  r.seeds = seeds_;
  r.points = points_;
  r.reference_spp = reference_spp_;
  r.work = work_;
  r.workers = workers;
  r.progress = isatty(STDERR_FILENO) == 1 ? &progress : nullptr;
  r.say = [](const std::string& sentence) { tell("photonloom: {}\n", sentence); };
  // Where nothing can be written, that is found before the work, not after it.
  if (asked && !output.empty() && output != "-") const OutputFile probe(output);
  std::error_code error;
  std::filesystem::create_directories(work_, error);
  if (error)
    throw std::runtime_error(fmt::format(
        "--work: {} cannot be made a folder ({}), expected a new one or one to go on with", work_,
        error.message()));
  PlanSearch search(r);
  // Text goes where it does not mix with the plan or with JSON.
  const bool apart = json || output == "-";
  const auto text = [apart]<class... Args>(fmt::format_string<Args...> format, Args&&... args) {
    if (apart)
      tell(format, std::forward<Args>(args)...);
    else
      fmt::print(format, std::forward<Args>(args)...);
  };

  const auto [width, height] = search.frame();
  const std::string name = metric_ == "flip" ? "HDR-FLIP" : "relMSE";
  Json j;
  j["scene"] = search.scene_name();
  j["frame"] = {width, height};
  j["metric"] = metric_;
  j["minimised"] = minimise_;
  LineValues around;
  double limit = 0;
  if (asked) {
    const PlanSearchResult found = search.meet(*asked);
    if (!found.best) throw CheckFailed("--error: " + found.binds);
    limit = found.limit;
    const MeasuredPlan& best = *found.best;
    around = best.lines;
    text("{}, {}x{}: least {} with a visible error ({}) of at most {:g}{}\n", search.scene_name(),
         width, height, minimise_, name, limit,
         asked->is_factor
             ? fmt::format(", {:g} times the default plan's in the same run", asked->error)
             : "");
    text("{}{}{}", header(), row(search, "best", best), row(search, "default", found.standard));
    std::vector<const MeasuredPlan*> runners;
    for (const MeasuredPlan& m : found.points) {
      const bool other = m.lines != best.lines && m.lines != found.standard.lines;
      if (other && m.error.mean <= 1.1 * limit) runners.push_back(&m);
    }
    std::stable_sort(runners.begin(), runners.end(), [&](auto* a, auto* b) {
      return std::fabs(std::log(search.objective(a->cost) / search.objective(best.cost))) <
             std::fabs(std::log(search.objective(b->cost) / search.objective(best.cost)));
    });
    if (runners.size() > 3) runners.resize(3);
    Json& losers = j["runners_up"] = Json::array();
    for (size_t i = 0; i < runners.size(); ++i) {
      const std::string why = why_it_lost(search, *runners[i], best, limit);
      text("{}    lost: {}\n", row(search, fmt::format("{}.", i + 2), *runners[i]), why);
      losers.push_back(measured_json(*runners[i]));
      losers.back()["lost"] = why;
    }
    const auto saved = [&](double mine, double standard) { return 100 * (1 - mine / standard); };
    text(
        "  saves, of the default plan: {:.0f} % of the cycles, {:.0f} % of the bytes, {:.0f} % "
        "of the gatherer's LUT-eq\n",
        saved(best.cost.cycles, found.standard.cost.cycles),
        saved(best.cost.bytes, found.standard.cost.bytes),
        saved(best.cost.gatherer_lut, found.standard.cost.gatherer_lut));
    const auto predicted = [&](const auto& figure) {
      return std::count_if(found.points.begin(), found.points.end(),
                           [&](const MeasuredPlan& m) { return figure(m) > 0; });
    };
    const int columns = std::min(r.measured_width, width),
              rows = std::min(r.measured_height, height);
    text(
        "  measured: {}, seeds {} to {}, two references of {} samples a pixel; ± is a "
        "standard error; 'a run <' is what a run with another seed exceeds in one case of "
        "twenty, 'beyond E <' the same of what it has more than {}\n"
        "  predicted before they were measured, of {} plans: the error of {}, the {} of {}; errors "
        "of the model, each plan from the others, {:.1f} % (root mean square), of {} {:.1f} %\n",
        columns == width && rows == height
            ? "all pixels"
            : fmt::format("one pixel of each of {}x{} parts of the frame", columns, rows),
        r.seed, r.seed + static_cast<uint64_t>(seeds_) - 1, reference_spp_,
        asked->is_factor
            ? fmt::format("{:g} times the default plan's in the same run", asked->error)
            : "E",
        found.points.size(), predicted([](const MeasuredPlan& m) { return m.predicted_error; }),
        minimise_,
        predicted([&](const MeasuredPlan& m) { return search.objective(m.predicted_cost); }),
        100 * found.error_prediction, minimise_, 100 * found.cost_prediction);
    j["limit"] = limit;
    j["best"] = measured_json(best);
    j["default"] = measured_json(found.standard);
    j["measured_plans"] = found.points.size();
    j["error_prediction_rms"] = found.error_prediction;
    j["cost_prediction_rms"] = found.cost_prediction;
  }
  const auto print_curve = [&](const std::string& line) {
    text("{} over {}, all else as in {}\n{}", name, line,
         asked ? "the plan above" : "the default plan", header());
    Json& points = j["curves"][line] = Json::array();
    for (const PlanSearch::CurvePoint& p : search.curve(line, around)) {
      if (!p.measured) {
        text("  {:<10} no plan: {}\n", p.value, p.refused);
        points.push_back({{"value", p.value}, {"refused", p.refused}});
        continue;
      }
      text("{}", row(search, p.value, *p.measured));
      points.push_back(measured_json(*p.measured));
      points.back()["value"] = p.value;
    }
  };
  if (advise_)
    for (const char* line : {"photons", "gather.k", "radius_scale"}) print_curve(line);
  if (!explain_.empty()) print_curve(explain_);
  if (asked) {
    PlanSearch::Written written = search.write(around);
    for (const auto& [line, value] : joined_lines({}, around))
      for (const std::string& decided : decided_lines(line))
        written.reasons[decided] =
            fmt::format("for {} of at most {:g} with the least {}", name, limit, minimise_);
    j["command"] = written.command;
    text("  the same without searching: {}\n", written.command);
    if (output == "-") {
      fmt::print("{}", plan_text(written.plan, written.reasons));
    } else if (!output.empty()) {
      write_plan(written.plan, output, written.reasons);
      text("wrote {} (hash {})\n", output, plan_hash_text(written.plan));
      j["plan"] = output;
    }
    j["hash"] = plan_hash_text(written.plan);
    if (!json && output != "-") describe(written.plan);
  }
  std::string missed;
  if (check_) {
    const MeasuredPlan m = search.check(around, *check_);
    text(
        "  the whole frame with seed {}, against references of {} samples a pixel: {} "
        "{:.5f}, HDR-FLIP {:.4f}, "
        "{:.1f} cycles and {:.0f} bytes a gather\n",
        *check_, search.check_spp(), name, m.error.mean, m.flip, m.cost.cycles, m.cost.bytes);
    double run_limit = limit;
    if (asked->is_factor) {
      const double standard = search.check({}, *check_).error.mean;
      run_limit = asked->error * standard;
      text("  the default plan's has {:.5f}; {:g} times that is {:.5f}\n", standard, asked->error,
           run_limit);
    }
    j["check"] = {{"seed", *check_},         {"reference_spp", search.check_spp()},
                  {"error", m.error.mean},   {"limit", run_limit},
                  {"relmse", m.relmse},      {"flip", m.flip},
                  {"cycles", m.cost.cycles}, {"bytes", m.cost.bytes}};
    if (m.error.mean > run_limit)
      missed = fmt::format("--check: the whole frame with seed {} has {:.5f}, above {:g}", *check_,
                           m.error.mean, run_limit);
  }
  if (json) fmt::print("{}\n", json_text(j));
  if (!missed.empty()) throw CheckFailed(missed);
}

}  // namespace photonloom
