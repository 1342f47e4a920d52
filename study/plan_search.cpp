// SPDX-License-Identifier: Apache-2.0
#include "study/plan_search.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <stdexcept>
#include <tuple>

#include "golden/planner/planner.hpp"
#include "golden/planner/resources.hpp"
#include "rtl/generate/hardware.hpp"
#include "study/board_room.hpp"
#include "study/collector.hpp"
#include "study/error_model.hpp"
#include "study/point_plan.hpp"
#include "study/store.hpp"
#include "study/workers.hpp"
#include "verilator_tb/model/tools.hpp"

namespace photonloom {
namespace {

// One-sided, one case of twenty.
constexpr double kSigmas = 1.645;
constexpr size_t kSearchSeeds = 2;
constexpr int kLatency = 60;  // of the line memory, cycles
constexpr int kGatherQueries = 1024;
constexpr double kWorthIt = 0.005;  // cheaper by this part is cheaper
// Cheaper by this part is worth all seeds, though bounds usually take more than is left.
constexpr double kClearlyCheaper = 0.05;

// One line of the plan for both, as the two are compared with each other.
constexpr const char* kDirections = "photon.direction_bits+gather.normal_bits";

// A line that the planner may choose: its values in order, those that ask for more first, and which
// of them the default plan has.
struct ChosenLine {
  std::string name;
  std::vector<std::string> values;
  int standard = 0;
  bool exact = false;  // changes no photon of an estimate, only what finding it costs
};

std::vector<ChosenLine> chosen_lines(uint64_t photons, uint64_t caustic_photons) {
  const auto counts = [](uint64_t standard, const std::vector<double>& factors) {
    // Few are told over fewer values, each once.
    const auto least = static_cast<int64_t>(std::min<uint64_t>(standard, 16));
    std::vector<std::string> values;
    for (const double f : factors)
      values.push_back(std::to_string(std::max<int64_t>(
          least, static_cast<int64_t>(std::llround(static_cast<double>(standard) * f)))));
    values.erase(std::unique(values.begin(), values.end()), values.end());
    return values;
  };
  return {
      {"gather.k",
       {"50", "40", "32", "26", "22", "18", "16", "14", "12", "11", "10", "9", "8", "7", "6", "5",
        "4", "3"}},
      {"photons",
       counts(photons, {4, 2, 1, 0.75, 0.5, 0.375, 0.25, 0.1875, 0.125, 0.09375, 0.0625, 0.046875,
                        0.03125, 0.015625}),
       2},
      {"caustic_photons",
       counts(caustic_photons, {2, 1, 0.5, 0.25, 0.125, 0.0625, 0.03125, 0.015625}), 1},
      {"radius_scale", {"1.5", "1.2", "1", "0.85", "0.7", "0.6", "0.5", "0.4"}, 2},
      {"photon.position_bits", {"16", "14", "13", "12", "11", "10", "9"}},
      {"photon.mantissa_bits", {"9", "7", "6", "5", "4", "3"}},
      {kDirections, {"8", "7", "6", "5", "4"}},
      {"gather.epsilon_factor", {"1", "2", "3", "4", "6", "8", "12", "16"}},
      {"gather.leaf_limit", {"0", "48", "32", "24", "16", "12", "8"}},
      {"packed", {"false", "true"}, 0, true},
      {"photon.bucket", {"16", "8", "4"}, 1, true},
      {"gatherer.lanes", {"16", "8", "4", "2", "1"}, 2, true},
      {"gatherer.contexts", {"32", "24", "16", "8", "4", "2"}, 2, true},
      {"gatherer.cache_bytes",
       {"65536", "32768", "16384", "8192", "4096", "2048", "1024"},
       2,
       true},
  };
}

// What the frame's size is asked for with.
constexpr const char* kSizeOption = "--size";

// Whether 0 is the least that a number of the plan may be: of most such lines it means none.
bool begins_at_zero(const std::string& name) {
  bool does = false;
  const Plan plan;
  Plan::visit(plan, [&](const char* section, const char* key, const auto& value, auto smallest,
                        auto, const char*) {
    using Value = std::decay_t<decltype(value)>;
    if constexpr (std::is_arithmetic_v<Value> && !std::is_same_v<Value, bool>)
      does |= smallest == 0 && name == fmt::format("{}.{}", section, key);
  });
  return does;
}

// What a line of numbers is in the plan; of one that is none of the plan's, nothing.
std::optional<std::string> own_value(const std::string& name, const Plan& plan) {
  std::optional<std::string> own;
  Plan::visit(
      plan, [&](const char* section, const char* key, const auto& value, auto, auto, const char*) {
        using Value = std::decay_t<decltype(value)>;
        if constexpr (std::is_arithmetic_v<Value> && !std::is_same_v<Value, bool>)
          if (name == fmt::format("{}.{}", section, key)) own = fmt::format("{}", value);
      });
  return own;
}

// Values of a line that the planner does not choose: half, the same and double of what it is, or
// all its words. Throws std::runtime_error where the line has none.
std::vector<std::string> other_values(const std::string& name, const Plan& plan) {
  std::optional<double> now;
  bool known = false, whole = false;
  double least = 0, most = 0;  // 0: no most
  Plan::visit(plan, [&](const char* section, const char* key, const auto& value, auto smallest,
                        auto largest, const char*) {
    if (name != fmt::format("{}.{}", section, key)) return;
    known = true;
    using Value = std::decay_t<decltype(value)>;
    if constexpr (std::is_arithmetic_v<Value> && !std::is_same_v<Value, bool>) {
      now = static_cast<double>(value);
      whole = std::is_integral_v<Value>;
      least = static_cast<double>(smallest);
      most = static_cast<double>(largest);
    }
  });
  if (!known)
    throw std::runtime_error(
        fmt::format("--explain: the plan has no line {}, expected one of docs/plan.md", name));
  if (name == "frame.width" || name == "frame.height")
    throw std::runtime_error(
        fmt::format("--explain: {} is decided by {}, and errors of frames of different sizes are "
                    "not compared",
                    name, kSizeOption));
  if (std::vector<std::string> words = plan_line_words(name); !words.empty()) return words;
  if (!now)
    throw std::runtime_error(fmt::format("--explain: {} has no values to choose from", name));
  std::vector<std::string> values;
  for (const double factor : {0.25, 0.5, 0.75, 1.0, 1.25, 1.5, 2.0, 4.0}) {
    const double x = *now == 0 ? factor * 4 : *now * factor;
    if (whole && (std::floor(x) < least || (most != 0 && x > most))) continue;
    const std::string text = fmt::format("{}", whole ? std::floor(x) : x);
    if (std::find(values.begin(), values.end(), text) == values.end()) values.push_back(text);
  }
  if (*now == 0) values.insert(values.begin(), "0");
  return values;
}

double value_of(const std::string& measure_name, const Measurement& m, const std::string& column) {
  const std::vector<Column>& columns = measure(measure_name).columns;
  for (size_t c = 0; c < columns.size(); ++c)
    if (column == columns[c].name) return m.values.at(c);
  throw std::logic_error("no column " + column);
}

double mean_of(const std::vector<Result>& results, const std::string& measure_name,
               const std::string& column) {
  double sum = 0;
  for (const Result& r : results)
    sum += value_of(measure_name, r.measures.at(measure_name).figures, column);
  return sum / static_cast<double>(results.size());
}

// Over all results; empty where all pixels were measured.
std::vector<double> mean_halves(const std::vector<Result>& results, const std::string& metric) {
  std::vector<double> mean;
  for (const Result& r : results) {
    const auto& blocks = r.measures.at("lot").figures.blocks;
    const auto halves = blocks.find(metric);
    if (halves == blocks.end()) return {};
    mean.resize(halves->second.size());
    for (size_t i = 0; i < mean.size(); ++i)
      mean[i] += halves->second[i] / static_cast<double>(results.size());
  }
  return mean;
}

// One more run differs as much as the seeds did, whatever their mean is off by.
double run_error(double seed_error, int seeds) {
  return seed_error * std::sqrt(static_cast<double>(seeds) + 1);
}

}  // namespace

double MeasuredError::error() const { return std::hypot(seed_error, pixel_error); }

double MeasuredError::bound() const {
  return mean + kSigmas * std::hypot(run_error(seed_error, seeds), pixel_error);
}

double MeasuredError::bound_beyond(double factor, const MeasuredError& standard) const {
  double pixels = 0;
  if (halves.size() == standard.halves.size() && !halves.empty())
    for (size_t i = 0; i < halves.size(); ++i)
      pixels = std::hypot(pixels, halves[i] - factor * standard.halves[i]);
  else
    pixels = std::hypot(pixel_error, factor * standard.pixel_error);
  // What the difference at the ratio measured varies by, and what the rest of the factor adds.
  const double rest = std::fabs(factor - mean / standard.mean) * standard.seed_error;
  const double run =
      std::hypot(run_error(beyond_seed_error, seeds), run_error(rest, standard.seeds));
  return mean - factor * standard.mean + kSigmas * std::hypot(run, pixels);
}

std::string lines_text(const LineValues& lines) {
  std::string text;
  for (const auto& [name, value] : lines)
    text += fmt::format("{}{} = {}", text.empty() ? "" : ", ", name, value);
  return text.empty() ? "the default plan" : text;
}

double usual_margin(std::vector<double> margins) {
  const auto quartile = margins.begin() + static_cast<ptrdiff_t>((margins.size() - 1) / 4);
  std::nth_element(margins.begin(), quartile, margins.end());
  return *quartile;
}

void check_curve_line(const std::string& line) {
  for (const ChosenLine& chosen : chosen_lines(1, 1))
    if (chosen.name == line) return;
  other_values(line, Plan());
}

class PlanSearch::Work {
 public:
  explicit Work(PlanSearchRequest request)
      : request_(std::move(request)), folder_(prepare_study()), store_(folder_) {
    lock_ = std::make_unique<FolderLock>(folder_, true);
    store_.remove_unfinished();
    scene_->load_references(study_, folder_ + "/references", request_.progress, request_.say);
    const Plan plan = plan_of_point(*scene_, study_, {}).plan;
    for (ChosenLine& line :
         chosen_lines(photons_asked("photons"), photons_asked("caustic_photons"))) {
      const bool idle = (line.name == "photons" && !plan.global.present) ||
                        (line.name == "caustic_photons" && !plan.caustic.present) ||
                        (line.name == "packed" && plan.compressed());
      if (is_free(line.name) && !idle) lines_.push_back(std::move(line));
    }
  }

  MeasuredPlan standard() {
    begin();
    confirm(0);
    return points_[0].measured;
  }

  PlanSearchResult meet(const ErrorLimit& limit) {
    // Where no plan fits the board nothing needs to be measured to tell.
    if (!fitting(standard_choice())) smallest_fitting();
    factor_ = limit.is_factor ? limit.error : 0;
    limit_ = limit.is_factor ? limit.error * standard().error.mean : limit.error;
    learn();
    PlanSearchResult result;
    result.limit = limit_;
    for (;;) {
      explore();
      // The cheapest that holds, or may hold as far as the search seeds say.
      const Point* best = nullptr;
      for (const Point& p : points_)
        if (is_hopeful(p) && (!best || value(p) < value(*best))) best = &p;
      if (!best || best->was_confirmed) best = doubtful(best);
      if (!best) {
        result.binds = what_binds();
        break;
      }
      if (!best->was_confirmed) {
        confirm(static_cast<size_t>(best - points_.data()));
        fit();
        continue;
      }
      result.best = best->measured;
      break;
    }
    confirm(0);
    for (Point& p : points_) p.measured.bound_beyond_limit = bound_beyond_limit(p.measured.error);
    if (result.best) result.best->bound_beyond_limit = bound_beyond_limit(result.best->error);
    result.standard = points_[0].measured;
    for (const Point& p : points_) result.points.push_back(p.measured);
    std::stable_sort(result.points.begin(), result.points.end(),
                     [&](const MeasuredPlan& a, const MeasuredPlan& b) {
                       return objective(a.cost) < objective(b.cost);
                     });
    result.error_prediction = model_->cross_validated() / power();
    double sum = 0;
    size_t n = 0;
    for (const Point& p : points_)
      if (const double was = objective(p.measured.predicted_cost); was > 0) {
        const double off = was / objective(p.measured.cost) - 1;
        sum += off * off;
        ++n;
      }
    result.cost_prediction = n > 0 ? std::sqrt(sum / static_cast<double>(n)) : 0;
    return result;
  }

  std::vector<CurvePoint> curve(const std::string& name, const LineValues& around) {
    std::vector<CurvePoint> curve;
    for (const std::string& value : curve_values(name, around)) {
      CurvePoint point{value, {}, {}};
      try {
        const LineValues lines = joined_lines(around, {{name, value}});
        point.refused = board_misfit(plan_of_point(*scene_, study_, lines).plan);
        if (point.refused.empty()) point.measured = measured(lines, kSearchSeeds);
      } catch (const PlanError& error) {
        point.refused = error.what();
      }
      if (point.measured && limit_ > 0)
        point.measured->bound_beyond_limit = bound_beyond_limit(point.measured->error);
      curve.push_back(std::move(point));
    }
    return curve;
  }

  Written write(const LineValues& lines) {
    const Study whole = whole_frame();
    StudyScene scene(request_.scene_file, whole, request_.parameters);
    PointPlan made = plan_of_point(scene, whole, lines);
    for (const auto& [name, value] : request_.parameters)
      made.command += " --define " + model_tools::shell_word(name + "=" + value);
    return {std::move(made.plan), std::move(made.reasons), std::move(made.command)};
  }

  int check_spp() const {
    const int64_t paths = int64_t{2} * study_.width * study_.height * study_.reference_spp;
    return static_cast<int>(std::max<int64_t>(16, paths / (int64_t{frame_.first} * frame_.second)));
  }

  MeasuredPlan check(const LineValues& lines, uint64_t seed) {
    Study whole = whole_frame();
    whole.reference_spp = check_spp();
    StudyScene scene(request_.scene_file, whole, request_.parameters);
    scene.load_references(
        whole, fmt::format("{}/{}.{}x{}", request_.work, scene.name(), whole.width, whole.height),
        request_.progress, request_.say);
    MeasuredPlan m;
    m.lines = lines;
    m.plan = plan_of_point(scene, whole, lines).plan;
    PointRun run(scene, whole, m.plan, seed, request_.work);
    const Measurement visible = measure("visible").run(run), gather = measure("gather").run(run);
    m.relmse = value_of("visible", visible, "relmse");
    m.flip = value_of("visible", visible, "flip");
    m.error.mean = request_.flip ? m.flip : m.relmse;
    m.error.seeds = 1;
    m.cost.cycles = value_of("gather", gather, "cycles");
    m.cost.bytes = value_of("gather", gather, "bytes");
    predict_luts(m.plan, m.cost);
    return m;
  }

  double objective(const PlanCost& cost) const {
    switch (request_.objective) {
      case PlanObjective::kCycles:
        return cost.cycles;
      case PlanObjective::kLuts:
        return cost.gatherer_lut;
      default:
        return cost.bytes;
    }
  }
  std::string scene_name() const { return scene_->name(); }
  std::pair<int, int> frame() const { return frame_; }

 private:
  using Choice = std::vector<int>;  // which value, for each of lines_

  struct Point {
    Choice choice;
    std::vector<double> terms;
    MeasuredPlan measured;
    bool was_confirmed = false;
  };
  struct Candidate {
    LineValues lines;
    Plan plan;
    std::vector<double> terms;
    std::string misfit;  // board_misfit()
    PlanCost cost;
  };

  Study whole_frame() const {
    Study whole = study_;
    std::tie(whole.width, whole.height) = frame_;
    whole.frame_width = whole.frame_height = 0;
    return whole;
  }

  // The scene and the study of its measured pixels; the folder of what is measured.
  std::string prepare_study() {
    if (!request_.board.empty()) board_ = predicted_board(request_.board);
    for (const auto& [names, value] : request_.asked)
      if (const std::string problem = line_problem(names, value, kSizeOption); !problem.empty())
        throw std::runtime_error(problem);
    study_.file = "--error";
    study_.name = "plan";
    study_.reference_spp = request_.reference_spp;
    study_.gather_queries = kGatherQueries;
    study_.latency = kLatency;
    for (int i = 0; i < request_.seeds; ++i)
      study_.seeds.push_back(request_.seed + static_cast<uint64_t>(i));
    const Scene scene = load_scene(request_.scene_file, request_.parameters);
    const auto [width, height] =
        request_.size.value_or(std::make_pair(scene.film.width, scene.film.height));
    frame_ = {width, height};
    study_.width = std::min(width, request_.measured_width);
    study_.height = std::min(height, request_.measured_height);
    if (study_.width < width || study_.height < height) {
      study_.frame_width = width;
      study_.frame_height = height;
    }
    study_.base = request_.asked;
    for (const auto& [name, value] :
         {std::make_pair("photons", "65536"), std::make_pair("caustic_photons", "500000")})
      if (is_free(name)) study_.base.emplace_back(name, value);
    scene_ = std::make_unique<StudyScene>(request_.scene_file, study_, request_.parameters);
    return fmt::format("{}/{}.{}x{}of{}x{}", request_.work, scene_->name(), study_.width,
                       study_.height, width, height);
  }

  // Whether the user left the line to the planner.
  bool is_free(const std::string& names) const {
    for (const auto& [name, value] : joined_lines({}, {{names, ""}}))
      for (const auto& [asked, its_value] : request_.asked) {
        if (asked == name) return false;
        if (name == "radius_scale" && asked.ends_with(".radius")) return false;
        if (name == "packed" && asked == "photon.photon_bytes") return false;
      }
    return true;
  }

  uint64_t photons_asked(const std::string& name) const {
    for (const auto& [line, value] : study_.base)
      if (line == name) return std::stoull(value);
    return 0;
  }

  LineValues lines_of(const Choice& choice) const {
    LineValues lines;
    for (size_t i = 0; i < lines_.size(); ++i)
      if (choice[i] != lines_[i].standard)
        lines.emplace_back(lines_[i].name, lines_[i].values[static_cast<size_t>(choice[i])]);
    return lines;
  }

  Plan framed(Plan plan) const {
    std::tie(plan.width, plan.height) = frame_;
    return plan;
  }

  // Why the board, where there is one, cannot have the plan or has no room for it; empty: it fits.
  std::string board_misfit(const Plan& plan) const {
    return board_ ? misfit(framed(plan), *board_, kBoardShare) : "";
  }

  Choice standard_choice() const {
    Choice choice;
    for (const ChosenLine& line : lines_) choice.push_back(line.standard);
    return choice;
  }

  // Steps of the lines that change the error.
  std::vector<double> place_of(const Choice& choice) const {
    std::vector<double> place;
    for (size_t i = 0; i < lines_.size(); ++i)
      if (!lines_[i].exact) place.push_back(choice[i]);
    return place;
  }

  // Nothing where no plan has these lines.
  const Candidate* candidate(const Choice& choice) {
    const auto known = candidates_.find(choice);
    if (known != candidates_.end()) return known->second ? &*known->second : nullptr;
    std::optional<Candidate>& made = candidates_[choice];
    try {
      const LineValues lines = lines_of(choice);
      Plan plan = plan_of_point(*scene_, study_, lines).plan;
      if (!base_) base_ = plan;
      std::vector<double> terms = error_terms(plan, *base_);
      std::string why = board_misfit(plan);
      made = Candidate{lines, std::move(plan), std::move(terms), std::move(why), {}};
    } catch (const PlanError&) {
      return nullptr;
    }
    return &*made;
  }

  // Nothing where the board has no room for it either.
  const Candidate* fitting(const Choice& choice) {
    const Candidate* c = candidate(choice);
    return c && c->misfit.empty() ? c : nullptr;
  }

  const PlanCost& cost_of(const Choice& choice) {
    Candidate& c = *candidates_.at(choice);
    if (c.cost.gatherer_lut == 0) {
      c.cost = costs_->predict(c.plan, request_.objective != PlanObjective::kLuts);
      predict_luts(framed(c.plan), c.cost);
    }
    return c.cost;
  }

  double value(const Point& p) const { return objective(p.measured.cost); }

  double predicted(const Choice& choice, const Candidate& c) const {
    return std::pow(model_->predict(c.terms, place_of(choice)), 1 / power()) * base_error();
  }
  double base_error() const { return points_[0].measured.error.mean; }
  // Causes add up in squared errors: FLIP goes with the root of them.
  double power() const { return request_.flip ? 2 : 1; }

  double bound_beyond_limit(const MeasuredError& e) const {
    return factor_ > 0 ? e.bound_beyond(factor_, points_[0].measured.error) : e.bound() - limit_;
  }
  bool holds(const MeasuredError& e) const { return bound_beyond_limit(e) <= 0; }
  double margin_of(const MeasuredError& e) const {
    return (limit_ + bound_beyond_limit(e)) / e.mean;
  }

  // The largest measured mean with which another run of the whole frame would probably still be
  // within the limit.
  double limit_of_means() const {
    std::vector<double> margins{margin_of(points_[0].measured.error)};
    for (size_t i = 1; i < points_.size(); ++i)
      if (points_[i].was_confirmed) margins.push_back(margin_of(points_[i].measured.error));
    return limit_ / usual_margin(std::move(margins));
  }

  bool is_hopeful(const Point& p) {
    if (!fitting(p.choice)) return false;
    const MeasuredError& e = p.measured.error;
    return p.was_confirmed ? holds(e) : e.mean <= limit_of_means();
  }

  // The cheapest that is within the limit as far as the search seeds say, if not by what bounds
  // usually take, and clearly cheaper than `best`, where there is one; `best` where there is none.
  // So nothing loses to a dearer plan, or to none, that all seeds would have let win.
  const Point* doubtful(const Point* best) {
    const Point* cheapest = best;
    for (const Point& p : points_)
      if (!p.was_confirmed && fitting(p.choice) && p.measured.error.mean <= limit_ &&
          (!best || value(p) < value(*best) * (1 - kClearlyCheaper)) &&
          (!cheapest || value(p) < value(*cheapest)))
        cheapest = &p;
    return cheapest;
  }

  // --- Measuring.

  Result result_of(const Plan& plan, uint64_t seed) {
    static const char* const kMeasures[] = {"visible", "lot", "gather"};
    const ResultKey key{scene_->hash_text(), plan_hash_text(plan), seed};
    std::optional<Result> old;
    try {
      old = store_.find(key);
    } catch (const std::runtime_error&) {
      // Damaged: made again.
    }
    Result result = old.value_or(Result{});
    result.key = key;
    result.failure.clear();
    PointRun run(*scene_, study_, plan, seed, request_.work);
    bool changed = false;
    for (const char* name : kMeasures) {
      const Measure& m = measure(name);
      const std::string settings = m.settings(study_, *scene_);
      const auto taken = result.measures.find(name);
      if (taken != result.measures.end() && taken->second.settings == settings &&
          taken->second.figures.values.size() == m.columns.size())
        continue;
      result.measures[name] = {settings, m.run(run)};
      changed = true;
    }
    if (changed) store_.put(result);
    return result;
  }

  // The plan with these lines with the first `seeds` seeds. Throws PlanError where there is none.
  MeasuredPlan measured(const LineValues& lines, size_t seeds) {
    MeasuredPlan m;
    m.lines = lines;
    m.plan = plan_of_point(*scene_, study_, lines).plan;
    measure_again(m, seeds);
    return m;
  }

  void measure_again(MeasuredPlan& m, size_t seeds) {
    seeds = std::min(seeds, study_.seeds.size());
    std::vector<Result> results(seeds);
    each_on_worker(request_.workers, seeds,
                   [&](size_t i) { results[i] = result_of(m.plan, study_.seeds[i]); });
    if (standard_.size() < seeds && m.lines.empty()) standard_ = results;
    const std::vector<Result> standard(
        standard_.begin(),
        standard_.begin() + static_cast<ptrdiff_t>(std::min(seeds, standard_.size())));
    const Means means = means_of(results, standard);
    const std::string metric = request_.flip ? "flip" : "relmse";
    m.relmse = means.at("visible.relmse").mean;
    m.flip = means.at("visible.flip").mean;
    m.error.mean = request_.flip ? m.flip : m.relmse;
    m.error.seed_error = seeds > 1 ? means.at("visible." + metric).error : 0;
    if (seeds > 1 && standard.size() == seeds) {
      const double standard_mean = mean_of(standard, "visible", metric);
      m.error.beyond_seed_error = means.at("visible." + metric).ratio_error * standard_mean;
    }
    m.error.halves = mean_halves(results, metric);
    m.error.pixel_error =
        m.error.halves.empty() ? mean_of(results, "lot", metric) : root_of_squares(m.error.halves);
    m.error.seeds = static_cast<int>(seeds);
    m.cost.cycles = mean_of(results, "gather", "cycles");
    m.cost.bytes = mean_of(results, "gather", "bytes");
    predict_luts(framed(m.plan), m.cost);
  }

  void say(const std::string& sentence) const {
    if (request_.say) request_.say(sentence);
  }

  void tell(const char* done, const MeasuredPlan& m) const {
    const std::string cost =
        std::isfinite(m.cost.cycles)
            ? fmt::format("{:.1f} cycles, {:.0f} bytes", m.cost.cycles, m.cost.bytes)
            : "no gathers";
    say(fmt::format("{} {}, {} seeds: {} {:.5f} ± {:.5f}, {}, {:.0f} LUT-eq", done,
                    lines_text(m.lines), m.error.seeds, request_.flip ? "FLIP" : "relMSE",
                    m.error.mean, m.error.error(), cost, m.cost.gatherer_lut));
  }

  void add(const Choice& choice) {
    for (const Point& p : points_)
      if (p.choice == choice) return;
    const Candidate* c = candidate(choice);
    if (!c) return;
    Point p{choice, c->terms, {}, false};
    if (model_) p.measured.predicted_error = predicted(choice, *c);
    if (costs_) p.measured.predicted_cost = cost_of(choice);
    const MeasuredPlan was = p.measured;
    p.measured = measured(c->lines, kSearchSeeds);
    p.measured.predicted_error = was.predicted_error;
    p.measured.predicted_cost = was.predicted_cost;
    tell("measured", p.measured);
    points_.push_back(std::move(p));
  }

  void confirm(size_t i) {
    Point& p = points_[i];
    if (p.was_confirmed) return;
    p.was_confirmed = true;
    // Where two seeds confirm, they were measured already.
    if (p.measured.error.seeds == static_cast<int>(study_.seeds.size())) return;
    measure_again(p.measured, study_.seeds.size());
    tell("confirmed", p.measured);
  }

  // --- Learning what costs error.

  // The default plan, and the queries that costs are predicted from.
  void begin() {
    if (!points_.empty()) return;
    const Choice standard = standard_choice();
    if (!candidate(standard)) plan_of_point(*scene_, study_, {});  // throws the reason
    add(standard);
    if (!std::isfinite(points_[0].measured.cost.cycles))
      throw std::runtime_error(
          fmt::format("{}: the default plan's frame asks for no gathers, so no plan makes them "
                      "cheaper; expected --gather-rays above 0, or a scene in whose view light is "
                      "gathered",
                      scene_->name()));
    if (points_[0].measured.error.mean <= 0)
      throw std::runtime_error(fmt::format(
          "{}: the default plan's error is {:.3g}, not above 0: nothing can be planned from it; "
          "more --reference-spp, or a scene with light in view",
          scene_->name(), points_[0].measured.error.mean));
    PointRun run(*scene_, study_, points_[0].measured.plan, study_.seeds[0], request_.work);
    costs_ = std::make_unique<PlanCosts>(*scene_, points_[0].measured.plan, run.watched_queries(),
                                         study_.seeds[0], kLatency);
  }

  void learn() {
    begin();
    if (model_) return fit();
    const Choice standard = standard_choice();
    // A far value of each group of lines, all else as in the default plan.
    const std::vector<std::vector<std::pair<std::string, std::string>>> probes = {
        {{"gather.k", "8"}},
        {{"photons", "1/8"}},
        {{"caustic_photons", "1/16"}},
        {{"gather.k", "8"}, {"photons", "1/8"}, {"caustic_photons", "1/16"}, {"packed", "true"}},
        {{"photon.position_bits", "10"}},
        {{"photon.mantissa_bits", "4"}, {kDirections, "4"}, {"packed", "true"}},
        {{"gather.epsilon_factor", "4"}, {"gather.k", "16"}},
        {{"radius_scale", "0.6"}, {"gather.k", "16"}},
    };
    for (const auto& probe : probes) {
      Choice choice = standard;
      bool moves = false;
      for (const auto& [name, value] : probe)
        for (size_t i = 0; i < lines_.size(); ++i)
          if (lines_[i].name == name) {
            const auto& values = lines_[i].values;
            auto at = std::find(values.begin(), values.end(), value);
            if (value == "1/8") at = values.begin() + lines_[i].standard + 6;
            if (value == "1/16") at = values.begin() + lines_[i].standard + 4;
            if (at == values.end()) continue;
            choice[i] = static_cast<int>(at - values.begin());
            moves = true;
          }
      // The last plan that may be measured is one that the model chose.
      if (moves && points_.size() + 1 < static_cast<size_t>(request_.points)) add(choice);
    }
    fit();
  }

  void fit() {
    std::vector<ErrorSample> samples;
    for (const Point& p : points_)
      samples.push_back({p.terms, place_of(p.choice),
                         std::pow(std::max(p.measured.error.mean / base_error(), 1e-3), power())});
    model_ = std::make_unique<ErrorModel>(std::move(samples));
  }

  // --- Searching.

  // Measures what the model takes for the cheapest within the limit, until that is known.
  void explore() {
    while (points_.size() < static_cast<size_t>(request_.points)) {
      std::optional<Choice> choice = cheapest();
      if (!choice) choice = most_exact();
      const size_t before = points_.size();
      add(*choice);
      if (points_.size() == before) return;
      fit();
    }
  }

  // The error of a choice as far as it is known: measured, else predicted.
  double expected(const Choice& choice, const Candidate& c) const {
    for (const Point& p : points_)
      if (p.choice == choice) return p.measured.error.mean;
    return predicted(choice, c);
  }

  bool may_hold(const Choice& choice) {
    for (const Point& p : points_)
      if (p.choice == choice && p.was_confirmed && !holds(p.measured.error)) return false;
    const Candidate* c = fitting(choice);
    return c && expected(choice, *c) <= limit_of_means();
  }

  // From each plan that may hold: to another value of a line, or of two, as long as that is
  // cheaper.
  std::optional<Choice> cheapest() {
    std::optional<Choice> best;
    std::vector<Choice> starts;
    if (const auto exact = most_exact(); may_hold(exact)) starts.push_back(exact);
    std::optional<size_t> measured_best;
    for (size_t i = 0; i < points_.size(); ++i)
      if (may_hold(points_[i].choice) &&
          (!measured_best || value(points_[i]) < value(points_[*measured_best])))
        measured_best = i;
    if (measured_best) starts.push_back(points_[*measured_best].choice);
    for (Choice at : starts) {
      while (improve(at)) {
      }
      if (!best || objective(cost_of(at)) < objective(cost_of(*best)) * (1 - kWorthIt)) best = at;
    }
    return best;
  }

  bool take_if_cheaper(Choice& at, const Choice& next) {
    if (next == at || !may_hold(next)) return false;
    if (objective(cost_of(next)) >= objective(cost_of(at)) * (1 - kWorthIt)) return false;
    at = next;
    return true;
  }

  bool improve(Choice& at) {
    bool improved = false;
    for (size_t i = 0; i < lines_.size(); ++i)
      for (size_t v = 0; v < lines_[i].values.size(); ++v) {
        Choice next = at;
        next[i] = static_cast<int>(v);
        improved |= take_if_cheaper(at, next);
      }
    if (improved) return true;
    // One a step coarser for another a step finer.
    for (size_t i = 0; i < lines_.size(); ++i)
      for (const int step : {1, 2})
        for (size_t j = 0; j < lines_.size(); ++j)
          for (const int other : {-1, -2, 1}) {
            if (i == j) continue;
            Choice next = at;
            next[i] += step;
            next[j] += other;
            const auto in_range = [&](size_t l) {
              return next[l] >= 0 && next[l] < static_cast<int>(lines_[l].values.size());
            };
            if (in_range(i) && in_range(j) && take_if_cheaper(at, next)) return true;
          }
    return false;
  }

  // The plan of the least predicted error.
  Choice most_exact() {
    Choice at = standard_choice();
    if (!fitting(at)) at = smallest_fitting();
    for (bool improved = true; improved;) {
      improved = false;
      for (size_t i = 0; i < lines_.size(); ++i) {
        if (lines_[i].exact) continue;
        for (size_t v = 0; v < lines_[i].values.size(); ++v) {
          Choice next = at;
          next[i] = static_cast<int>(v);
          const Candidate *now = fitting(at), *then = fitting(next);
          if (!now || !then || next == at) continue;
          // What the model takes for nothing is not asked for.
          if (predicted(next, *then) < predicted(at, *now) * (1 - 0.005)) {
            at = next;
            improved = true;
          }
        }
      }
    }
    return at;
  }

  // Of what does not fit a board: narrower, with fewer photons, until it does.
  Choice smallest_fitting() {
    Choice at = standard_choice();
    for (const char* name : {"packed", "gatherer.contexts", "gatherer.lanes", "gather.k", "photons",
                             "caustic_photons"})
      for (size_t i = 0; i < lines_.size(); ++i) {
        if (lines_[i].name != name) continue;
        // What a given line does not go with is left out: the reason is then what lacks.
        for (Choice next = at;
             !fitting(at) && ++next[i] < static_cast<int>(lines_[i].values.size());)
          if (candidate(next)) at = next;
      }
    const Candidate* c = candidate(at);
    if (!c) plan_of_point(*scene_, study_, lines_of(at));  // throws the reason
    if (!c->misfit.empty())
      throw std::runtime_error(
          fmt::format("--board: no plan that the planner knows fits {}: the smallest {}",
                      request_.board, c->misfit));
    return at;
  }

  // --- When nothing meets the error.

  std::string what_binds() {
    const auto least =
        std::min_element(points_.begin(), points_.end(), [](const Point& a, const Point& b) {
          return a.measured.error.mean < b.measured.error.mean;
        });
    confirm(static_cast<size_t>(least - points_.begin()));
    const MeasuredPlan& best = least->measured;
    std::string text = fmt::format(
        "no plan of {} is known to stay within {:g}: the best found has {:.5f} ± {:.5f}, and "
        "another run of it may have {:.5f}{} ({})",
        scene_->name(), limit_, best.error.mean, best.error.error(), best.error.bound(),
        factor_ > 0 ? fmt::format(", {:.5f} beyond {:g} times the default plan's",
                                  bound_beyond_limit(best.error), factor_)
                    : "",
        lines_text(best.lines));
    // What more of each cause's cure would give, measured.
    const Plan& plan = best.plan;
    double cured = best.error.mean;
    std::string cure;
    for (const auto& [line, value] :
         {std::make_pair(std::string("frame.gather_rays"), 2 * plan.gather_rays),
          std::make_pair(std::string("frame.spp"), 2 * plan.spp)}) {
      if (value == 0) continue;
      try {
        const MeasuredPlan more =
            measured(joined_lines(best.lines, {{line, std::to_string(value)}}), kSearchSeeds);
        tell("measured", more);
        if (more.error.mean < cured) {
          cured = more.error.mean;
          cure = fmt::format("{} {}", line == "frame.spp" ? "--spp" : "--gather-rays", value);
        }
      } catch (const PlanError&) {
        // No plan has as many: that is no cure.
      }
    }
    const std::vector<double> parts = model_->parts(least->terms);
    const auto largest =
        static_cast<size_t>(std::max_element(parts.begin(), parts.end()) - parts.begin());
    double all = 0;
    for (const double p : parts) all += p;
    text += fmt::format("; what binds is {} ({:.0f} % of it)", error_term_names()[largest],
                        100 * parts[largest] / all);
    if (!cure.empty()) text += fmt::format("; {} would give {:.5f}", cure, cured);
    if (board_)
      if (const Candidate* c = candidate(standard_choice()); c && !c->misfit.empty())
        text += fmt::format("; the board binds too: the default plan {}", c->misfit);
    return text;
  }

  std::vector<std::string> curve_values(const std::string& name, const LineValues& around) const {
    std::vector<std::string> values = numbers_or_words(name, around);
    if (begins_at_zero(name) && std::find(values.begin(), values.end(), "0") == values.end())
      values.insert(values.begin(), "0");
    return values;
  }

  std::vector<std::string> numbers_or_words(const std::string& name,
                                            const LineValues& around) const {
    const Plan plan = plan_of_point(*scene_, study_, around).plan;
    for (const ChosenLine& line :
         chosen_lines(photons_asked("photons"), photons_asked("caustic_photons")))
      if (line.name == name) {
        std::vector<std::string> values = line.values;
        if (const std::optional<std::string> own = own_value(name, plan);
            own && std::find(values.begin(), values.end(), *own) == values.end()) {
          // Nor do those around it stand among the planner's.
          const std::vector<std::string> near = other_values(name, plan);
          values.insert(values.end(), near.begin(), near.end());
        }
        const auto number = [](const std::string& text) {
          return std::strtod(text.c_str(), nullptr);
        };
        std::sort(values.begin(), values.end(), [&](const std::string& a, const std::string& b) {
          return number(a) < number(b);
        });
        values.erase(std::unique(values.begin(), values.end()), values.end());
        return values;
      }
    return other_values(name, plan);
  }

  PlanSearchRequest request_;
  Study study_;
  std::pair<int, int> frame_;
  std::unique_ptr<StudyScene> scene_;
  std::optional<BoardDescription> board_;
  std::string folder_;
  ResultStore store_;
  std::unique_ptr<FolderLock> lock_;
  std::vector<ChosenLine> lines_;
  std::map<Choice, std::optional<Candidate>> candidates_;
  std::optional<Plan> base_;
  std::unique_ptr<PlanCosts> costs_;
  std::vector<Point> points_;     // the default plan first
  std::vector<Result> standard_;  // its results
  std::unique_ptr<ErrorModel> model_;
  double limit_ = 0;
  double factor_ = 0;  // of the default plan's error in the same run; 0: limit_ is the error itself
};

PlanSearch::PlanSearch(PlanSearchRequest request)
    : work_(std::make_unique<Work>(std::move(request))) {}
PlanSearch::~PlanSearch() = default;
MeasuredPlan PlanSearch::standard() { return work_->standard(); }
PlanSearchResult PlanSearch::meet(const ErrorLimit& limit) { return work_->meet(limit); }
std::vector<PlanSearch::CurvePoint> PlanSearch::curve(const std::string& line,
                                                      const LineValues& around) {
  return work_->curve(line, around);
}
PlanSearch::Written PlanSearch::write(const LineValues& lines) { return work_->write(lines); }
MeasuredPlan PlanSearch::check(const LineValues& lines, uint64_t seed) {
  return work_->check(lines, seed);
}
int PlanSearch::check_spp() const { return work_->check_spp(); }
double PlanSearch::objective(const PlanCost& cost) const { return work_->objective(cost); }
std::string PlanSearch::scene_name() const { return work_->scene_name(); }
std::pair<int, int> PlanSearch::frame() const { return work_->frame(); }

}  // namespace photonloom
