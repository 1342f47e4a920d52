// SPDX-License-Identifier: Apache-2.0
// The cheapest plan of a scene whose visible error stays within a bound: predicted from few plans
// that were measured on a part of the frame's pixels, measured itself, and confirmed with other
// seeds. docs/planner.md says how and what is promised.
#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "golden/numeric/progress.hpp"
#include "golden/plan/plan_file.hpp"
#include "golden/scene/scene.hpp"
#include "study/plan_costs.hpp"
#include "study/study_file.hpp"

namespace photonloom {

enum class PlanObjective { kCycles, kLuts, kBytes };
inline constexpr const char* kObjectiveNames[] = {"cycles", "luts", "bytes"};

struct PlanSearchRequest {
  std::string scene_file;
  Parameters parameters;
  std::optional<std::pair<int, int>> size;  // of the frame; else the film's
  // Pixels measured: each of one of so many equal parts of the frame.
  int measured_width = 64, measured_height = 64;
  LineValues asked;  // lines that the user fixed, as a study's [base]
  bool flip = false;
  PlanObjective objective = PlanObjective::kCycles;
  std::string board;  // empty: none
  uint64_t seed = 1;  // the plan's photons, and the first seed that is measured
  int seeds = 6;      // that confirm a plan; the first two of them search
  // Plans that a search measures at most, the default one among them. Confirming one measures no
  // further plan; the curves, and the two that tell what helps where nothing meets the error, come
  // on top.
  int points = 24;
  int reference_spp = 2048;
  std::string work;  // folder of references and results, to go on with
  int workers = 1;
  Progress* progress = nullptr;
  std::function<void(const std::string&)> say;  // a sentence for the user
};

// An error as measured.
struct MeasuredError {
  double mean = 0;
  double seed_error = 0;   // standard error of the mean, from how seeds differ
  double pixel_error = 0;  // standard error from which pixels were measured
  // As seed_error, of the difference to the default plan's error times the ratio of both, over the
  // same seeds; 0 for the default plan.
  double beyond_seed_error = 0;
  std::vector<double> halves;  // half_differences of the mean over seeds; empty: all pixels
  int seeds = 0;
  double error() const;  // of both
  // What one run of the whole frame with one more seed exceeds in one of twenty cases.
  double bound() const;
  // The same, beside `factor` times what the default plan has in its run with that seed: below 0
  // where it stays within. Measured on the same pixels with the same seeds, both err alike.
  double bound_beyond(double factor, const MeasuredError& standard) const;
};

// What an error may be: at most `error`, or so many times what the default plan has in the same
// run.
struct ErrorLimit {
  double error = 0;
  bool is_factor = false;
};

struct MeasuredPlan {
  LineValues lines;  // beyond what was asked
  Plan plan;         // of the measured pixels
  MeasuredError error;
  // What another run may have beyond the limit, and beyond a factor of the default plan's error in
  // that run; below 0 where it stays within. Nothing where there is no limit.
  std::optional<double> bound_beyond_limit;
  double relmse = 0, flip = 0;  // means; one of them is that of `error`
  PlanCost cost;                // measured, where a model gives the cycles from counted searches
  PlanCost predicted_cost;      // before it was rendered
  double predicted_error = 0;   // the same; 0: it was measured to learn from
};

struct PlanSearchResult {
  std::optional<MeasuredPlan> best;
  MeasuredPlan standard;             // the default plan
  double limit = 0;                  // as an error
  std::vector<MeasuredPlan> points;  // all that were measured, the cheapest first
  // Root mean squares of relative errors: of predicted errors, each plan from all others; of costs.
  double error_prediction = 0, cost_prediction = 0;
  std::string binds;  // why there is no best
};

// Throws std::runtime_error for a line over whose values PlanSearch::curve() cannot go.
void check_curve_line(const std::string& line);

class PlanSearch {
 public:
  // Loads the scene and the references, which it makes where `work` has none. Throws
  // std::runtime_error for a board that there is not or that states no resources and for lines that
  // no plan has.
  explicit PlanSearch(PlanSearchRequest request);
  ~PlanSearch();

  // The default plan, measured with all seeds.
  MeasuredPlan standard();

  PlanSearchResult meet(const ErrorLimit& limit);

  // The plan with `line` at each of some values, all else as `around`.
  struct CurvePoint {
    std::string value;
    std::optional<MeasuredPlan> measured;
    std::string refused;
  };
  std::vector<CurvePoint> curve(const std::string& line, const LineValues& around);

  // The plan of the whole frame with these lines, the reason for each line, and the command that
  // writes it.
  struct Written {
    Plan plan;
    PlanReasons reasons;
    std::string command;
  };
  Written write(const LineValues& lines);

  // One run of the whole frame with these lines and this seed, all pixels measured, with references
  // of check_spp() samples a pixel: twice as many paths as those of the measured pixels have.
  MeasuredPlan check(const LineValues& lines, uint64_t seed);
  int check_spp() const;

  double objective(const PlanCost& cost) const;
  std::string scene_name() const;
  std::pair<int, int> frame() const;

 private:
  class Work;
  std::unique_ptr<Work> work_;
};

// A line as a user writes it: "gather.k = 8, photons = 8192".
std::string lines_text(const LineValues& lines);

// By how much the bound of a run is more than the mean of the search, from those of confirmed
// plans: their lower quartile. A rare bright path says nothing of plans that do not meet it, and
// those that were confirmed for being alike meet it together. Too small a margin costs a plan that
// is confirmed in vain, too large a one the plan that was looked for.
double usual_margin(std::vector<double> margins);

}  // namespace photonloom
