// SPDX-License-Identifier: Apache-2.0
#include "study/runner.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <tuple>

#include "golden/numeric/output_file.hpp"
#include "golden/numeric/sha256.hpp"
#include "study/point_plan.hpp"
#include "study/routed.hpp"
#include "study/search.hpp"
#include "study/slurm.hpp"
#include "study/workers.hpp"

namespace photonloom {
namespace {

// How often an array job may leave work undone without getting on at all.
constexpr int kIdleRounds = 2;

class Sweep {
 public:
  explicit Sweep(const SweepRequest& request)
      : request_(request), study_(study_of(request)), store_(request.folder) {}

  SweepReport run() {
    std::unique_ptr<FolderLock> lock;
    if (!request_.is_task) {
      lock = std::make_unique<FolderLock>(request_.folder, request_.wait);
      if (!request_.on_slurm) store_.remove_unfinished();
    }
    const bool searches =
        std::any_of(study_.sets.begin(), study_.sets.end(),
                    [](const PointSet& s) { return s.strategy == Strategy::kSearch; });
    if (searches && !request_.is_task)
      if (const std::string why = search_missing(); !why.empty()) throw std::runtime_error(why);
    if (std::count(study_.measures.begin(), study_.measures.end(), kRouted))
      if (const std::string why = routing_missing(); !why.empty()) throw std::runtime_error(why);
    load_scenes();
    plan_points();
    for (const uint32_t n : request_.only)
      if (table_.points[n].point.origin == "search" && table_.points[n].point.lines.empty())
        throw StudyError(fmt::format(
            "--points: {} is a point of a search, which has not proposed it yet; expected a sweep "
            "without --points first",
            n));
    const std::vector<uint32_t> fixed = chosen();
    measure_points(fixed);
    if (searches && request_.only.empty()) search();
    if (!request_.is_task)
      report_.collected = collect(
          table_, store_,
          [&](const PlannedPoint& p, Result& r) { return stands(r, *scenes_[p.point.scene]); },
          request_.progress);
    return std::move(report_);
  }

 private:
  // Refused before anything is written.
  static Study study_of(const SweepRequest& request) {
    Study study = parse_study(read_file(request.study_file), request.study_file, measure_names());
    if (!request.scenes.empty())
      for (const std::string& sentence : replace_scenes(study, request.scenes))
        if (request.say) request.say(sentence);
    uint64_t points = 0;
    for (size_t s = 0; s < study.scenes.size(); ++s) points += points_of_scene(study, s);
    for (const uint32_t n : request.only)
      if (n >= points)
        throw PointsError(fmt::format("--points: {} is no point of {}, expected 0 to {}", n,
                                      study.file, points - 1));
    return study;
  }

  void say(const std::string& sentence) {
    const std::lock_guard lock(mutex_);
    if (request_.say) request_.say(sentence);
  }
  void fail(const std::string& sentence) {
    {
      const std::lock_guard lock(mutex_);
      report_.failures.push_back(sentence);
    }
    say(sentence);
  }

  void load_scenes() {
    for (const std::string& file : study_.scenes) {
      SceneEntry entry{std::filesystem::path(file).stem().string(), file, {}, {}, {}, 0};
      std::unique_ptr<StudyScene> scene;
      try {
        scene = std::make_unique<StudyScene>(file, study_);
        if (!study_.referenced().empty()) {
          scene->load_references(study_, request_.folder + "/references", request_.progress,
                                 [&](const std::string& sentence) { say(sentence); });
          entry.references = scene->references().signature;
          entry.references_relmse = scene->references().own_relmse;
        }
        entry.hash = scene->hash_text();
        refuse_other_references(entry);
      } catch (const std::exception& error) {
        scene.reset();
        entry.hash.clear();
        entry.failure = error.what();
        fail(fmt::format("scene {}: {}; the others go on", entry.name, error.what()));
      }
      table_.scenes.push_back(entry);
      scenes_.push_back(std::move(scene));
    }
  }

  // A result is known by its scene's content. Of two files of one content the second would have the
  // figures that the first has against its references.
  void refuse_other_references(const SceneEntry& entry) const {
    for (const SceneEntry& other : table_.scenes)
      if (other.hash == entry.hash && other.references != entry.references)
        throw std::runtime_error(fmt::format(
            "{} has the same content as {} but other references, and results are kept by a scene's "
            "content; expected the same references, or a folder for each",
            entry.file, other.file));
  }

  // All points and the plans of those that the study alone decides; from points.json where nothing
  // changed.
  void plan_points() {
    table_.study = study_.name;
    table_.seeds = study_.seeds;
    table_.measures = study_.measures;
    Sha256 source;
    source.add(study_.text);
    for (size_t s = 0; s < scenes_.size(); ++s) {
      source.add(table_.scenes[s].file + "\n");  // commands name it
      source.add(table_.scenes[s].hash + table_.scenes[s].references + table_.scenes[s].failure);
      // Whatever else plans follow from, this one does too.
      if (scenes_[s]) source.add(baseline_hash(s));
      source.add(fmt::format(" {}\n", baseline_seeds(study_, s)));
    }
    table_.source = source.hex();
    size_t count = 0;
    for (size_t s = 0; s < scenes_.size(); ++s) count += points_of_scene(study_, s);
    plans_.resize(count);
    const std::string file = request_.folder + "/points.json";
    if (std::filesystem::exists(file)) {
      std::optional<PointTable> old;
      try {
        old = parse_point_table(read_file(file));
        if (old->source == table_.source &&
            (old->points.size() != count || old->scenes.size() != scenes_.size()))
          throw std::runtime_error("has other points than its study");
      } catch (const std::exception&) {
        old.reset();
        say(fmt::format("{}: cannot be read; points are planned again", file));
      }
      if (old && old->source == table_.source) {
        table_.points = std::move(old->points);
        if (!request_.is_task) mend_plans();
        return;
      }
      if (old)
        say(
            fmt::format("{}: is of another study or scene, or of scene files elsewhere; points are "
                        "planned again",
                        file));
    }
    for (size_t s = 0; s < scenes_.size(); ++s) {
      std::vector<Point> fixed = fixed_points(study_, s);
      const uint32_t of_scene = points_of_scene(study_, s);
      for (uint32_t i = 0; i < of_scene; ++i) {
        PlannedPoint p;
        if (i < fixed.size()) p.point = std::move(fixed[i]);
        p.point.number = static_cast<uint32_t>(table_.points.size());
        p.point.scene = s;
        if (i >= fixed.size()) p.point.origin = "search";
        table_.points.push_back(p);
      }
    }
    std::vector<uint32_t> numbers;
    for (const PlannedPoint& p : table_.points)
      if (scenes_[p.point.scene] && p.point.origin != "search") numbers.push_back(p.point.number);
    plan_these(numbers);
    if (!request_.is_task) write_file(file, point_table_text(table_));
  }

  std::string baseline_hash(size_t scene) {
    try {
      return plan_hash_text(plan_of_point(*scenes_[scene], study_, {}).plan);
    } catch (const PlanError& error) {
      return error.what();
    }
  }

  void plan_these(std::vector<uint32_t> numbers) {
    const ProgressPhase phase(request_.progress, "plan", numbers.size(), "points");
    std::stable_sort(numbers.begin(), numbers.end(),
                     [&](uint32_t a, uint32_t b) { return shared_part(a, 0) < shared_part(b, 0); });
    each_on_worker(request_.workers, numbers.size(), [&](size_t i) {
      plan_of(numbers[i]);
      phase.advance(1);
    });
  }

  // Nothing where no plan has the point's lines.
  const Plan* plan_of(uint32_t number) {
    std::optional<Plan>& plan = plans_[number];
    PlannedPoint& p = table_.points[number];
    if (plan || !p.refused.empty()) return plan ? &*plan : nullptr;
    try {
      PointPlan made = plan_of_point(*scenes_[p.point.scene], study_, p.point.lines);
      const std::string hash = plan_hash_text(made.plan);
      if (!p.plan.empty() && p.plan != hash)
        throw std::runtime_error(fmt::format(
            "{}/points.json: point {} has plan {}, expected {}: this program plans otherwise; "
            "remove the file, and the points are planned again",
            request_.folder, number, p.plan, hash));
      p.plan = hash;
      p.command = made.command;
      keep_plan(hash, made);
      plan = made.plan;
    } catch (const PlanError& error) {
      p.refused = error.what();
    }
    return plan ? &*plan : nullptr;
  }

  // plans/HASH.toml: the plan with the reason for each line.
  void keep_plan(const std::string& hash, const PointPlan& made) const {
    if (is_kept(hash)) return;
    const std::string folder = request_.folder + "/plans";
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (error)
      throw std::runtime_error(fmt::format(
          "{}: cannot be made a folder ({}), expected one of plans", folder, error.message()));
    check_plan(made.plan);
    const std::string text = plan_text(made.plan, made.reasons);
    write_file(plan_file(hash), text + check_of(hash, text));
  }

  // The last line of plans/HASH.toml, by which it is known as whole without being parsed.
  static std::string check_of(const std::string& hash, std::string_view text) {
    return fmt::format("# plan {}, {}", hash, check_line(text));
  }

  std::string plan_file(const std::string& hash) const {
    return fmt::format("{}/plans/{}.toml", request_.folder, hash);
  }

  // By its hash: points of one plan may have different reasons for it.
  bool is_kept(const std::string& hash) const {
    try {
      const std::string text = read_file(plan_file(hash));
      // A file without the line, or with another, may still be the plan.
      const size_t last = text.rfind("\n# plan ") + 1;
      if (last > 0 && text.substr(last) == check_of(hash, std::string_view(text).substr(0, last)))
        return true;
      return plan_hash_text(parse_plan(text, plan_file(hash))) == hash;
    } catch (const std::runtime_error&) {
      return false;
    }
  }

  // Writes again the plans of points.json that are lost or damaged.
  void mend_plans() {
    std::vector<uint32_t> numbers;  // a point of each plan
    std::set<std::string> seen;
    for (const PlannedPoint& p : table_.points)
      if (scenes_[p.point.scene] && !p.plan.empty() && seen.insert(p.plan).second)
        numbers.push_back(p.point.number);
    std::vector<char> lost(numbers.size());
    each_on_worker(request_.workers, numbers.size(),
                   [&](size_t i) { lost[i] = !is_kept(table_.points[numbers[i]].plan); });
    std::vector<uint32_t> again;
    for (size_t i = 0; i < numbers.size(); ++i) {
      if (!lost[i]) continue;
      again.push_back(numbers[i]);
      say(fmt::format("{}: is not there or damaged; it is written again",
                      plan_file(table_.points[numbers[i]].plan)));
    }
    if (!again.empty()) plan_these(again);
  }

  std::vector<uint32_t> chosen() const {
    std::vector<uint32_t> numbers;
    for (const PlannedPoint& p : table_.points) {
      const bool planned = !p.plan.empty() || plans_[p.point.number];
      const bool asked =
          request_.only.empty()
              ? !p.point.origin.starts_with("search")
              : std::binary_search(request_.only.begin(), request_.only.end(), p.point.number);
      if (asked && planned) numbers.push_back(p.point.number);
    }
    return numbers;
  }

  // What decides which photons a result needs; results that share them are neighbours.
  std::tuple<size_t, uint64_t, std::string, std::string, uint32_t> shared_part(
      uint32_t number, uint64_t seed) const {
    const PlannedPoint& p = table_.points[number];
    std::string global, caustic;
    for (const auto& [line, value] : joined_lines(study_.base, p.point.lines)) {
      if (line == "photons") global = value;
      if (line == "caustic_photons") caustic = value;
    }
    return {p.point.scene, seed, global, caustic, number};
  }

  struct Task {
    uint32_t point;
    uint64_t seed;
    std::optional<Result> old;  // with figures that still stand
  };

  bool is_wanted(const std::string& measure, uint64_t seed) const {
    const auto first = study_.seeds.begin();
    if (measure == kRouted) return seed == *first;
    const auto fewer = study_.first_seeds.find(measure);
    return fewer == study_.first_seeds.end() ||
           std::find(first, first + fewer->second, seed) != first + fewer->second;
  }

  // Whether every figure that the study wants stands in the result; those that do not are removed.
  bool complete(Result& r, const StudyScene& scene) const {
    bool all = true;
    for (const std::string& name : study_.measures) {
      if (!is_wanted(name, r.key.seed)) continue;
      const auto taken = r.measures.find(name);
      const bool good = taken != r.measures.end() &&
                        taken->second.settings == measure(name).settings(study_, scene) &&
                        taken->second.figures.values.size() == measure(name).columns.size();
      if (!good && taken != r.measures.end()) r.measures.erase(taken);
      all &= good;
    }
    return all;
  }

  // As complete(), of a result that goes into a table: what the study does not want of this seed,
  // and so has not checked, is removed too.
  bool stands(Result& r, const StudyScene& scene) const {
    const bool all = complete(r, scene);
    std::erase_if(r.measures, [&](const auto& m) { return !is_wanted(m.first, r.key.seed); });
    return all;
  }

  // Results that are not there as they should be, a plan and seed once however many points have it.
  std::vector<Task> open_tasks(const std::vector<uint32_t>& numbers, bool speak) {
    std::vector<Task> tasks;
    std::set<ResultKey> seen;
    uint64_t kept = 0;
    for (const uint32_t n : numbers) {
      const PlannedPoint& p = table_.points[n];
      if (p.plan.empty()) continue;
      const SceneEntry& scene = table_.scenes[p.point.scene];
      for (const uint64_t seed : seeds_of(p.point, study_.seeds)) {
        const ResultKey key{scene.hash, p.plan, seed};
        if (!seen.insert(key).second) continue;
        Task task{n, seed, {}};
        try {
          task.old = store_.find(key);
        } catch (const std::runtime_error& error) {
          ++report_.again;
          if (speak) say(fmt::format("{}; it is computed again", error.what()));
        }
        if (task.old) {
          const size_t before = task.old->measures.size();
          if (complete(*task.old, *scenes_[p.point.scene])) {
            ++kept;
            continue;
          }
          const bool failed = !task.old->failure.empty();
          if (failed && speak)
            say(fmt::format("point {}, seed {}: failed before ({}); tried again", n, seed,
                            task.old->failure));
          if (failed || task.old->measures.size() < before) ++report_.again;
          task.old->failure.clear();
        }
        tasks.push_back(std::move(task));
      }
    }
    if (speak) report_.kept += kept;
    return tasks;
  }

  void measure_points(const std::vector<uint32_t>& numbers) {
    std::vector<Task> tasks = open_tasks(numbers, true);
    if (report_.again > 0 && request_.say)
      say(fmt::format("{} results are computed again", report_.again));
    if (tasks.empty()) return;
    if (request_.on_slurm) return measure_on_slurm(numbers, std::move(tasks));
    std::stable_sort(tasks.begin(), tasks.end(), [&](const Task& a, const Task& b) {
      return shared_part(a.point, a.seed) < shared_part(b.point, b.seed);
    });
    const ProgressPhase phase(request_.progress, "measure", tasks.size(), "results");
    each_on_worker(request_.workers, tasks.size(), [&](size_t i) {
      store_.put(measured(tasks[i]));
      phase.advance(1);
    });
  }

  Result measured(Task& task) {
    const PlannedPoint& p = table_.points[task.point];
    StudyScene& scene = *scenes_[p.point.scene];
    Result result = task.old.value_or(Result{});
    result.key = {scene.hash_text(), p.plan, task.seed};
    const auto start = std::chrono::steady_clock::now();
    try {
      const Plan* plan = plan_of(task.point);
      if (!plan) throw std::runtime_error(p.refused);
      PointRun run(scene, study_, *plan, task.seed, request_.work_dir);
      for (const std::string& name : study_.measures)
        if (is_wanted(name, task.seed) && !result.measures.count(name)) {
          const Measure& m = measure(name);
          result.measures[name] = {m.settings(study_, scene), m.run(run)};
        }
    } catch (const std::exception& error) {
      result.failure = error.what();  // figures that there are stand
      fail(fmt::format("point {}, scene {}, seed {}: {}; the others go on", task.point,
                       scene.name(), task.seed, error.what()));
    }
    result.seconds +=
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    const std::lock_guard lock(mutex_);
    ++report_.computed;
    return result;
  }

  void measure_on_slurm(const std::vector<uint32_t>& numbers, std::vector<Task> tasks) {
    const size_t all = tasks.size();
    const ProgressPhase phase(request_.progress, "measure", all, "results");
    size_t shown = 0;
    const auto show = [&](size_t left) {
      if (all - left > shown) phase.advance(all - left - shown);
      shown = std::max(shown, all - left);
    };
    for (int idle = 0; !tasks.empty();) {
      SlurmWork work{request_.program, request_.study_file, request_.folder, request_.work_dir, {}};
      std::set<uint32_t> points;
      for (const Task& t : tasks) points.insert(t.point);
      work.points.assign(points.begin(), points.end());
      // A look into the folder takes longer the more there is.
      auto looked = std::chrono::steady_clock::now();
      run_on_slurm(work, [&] {
        if (std::chrono::steady_clock::now() - looked < std::chrono::seconds(2)) return;
        show(undone(tasks));
        looked = std::chrono::steady_clock::now();
      });
      const size_t before = tasks.size();
      std::vector<Task> left = open_tasks(numbers, false);
      std::erase_if(left, [&](const Task& t) {
        // A failure that a task has stored is an answer, not work left undone.
        const PlannedPoint& p = table_.points[t.point];
        std::optional<Result> r;
        try {
          r = store_.find({table_.scenes[p.point.scene].hash, p.plan, t.seed});
        } catch (const std::runtime_error&) {
        }
        if (!r || r->failure.empty()) return false;
        fail(fmt::format("point {}, scene {}, seed {}: {}; the others go on", t.point,
                         table_.scenes[p.point.scene].name, t.seed, r->failure));
        return true;
      });
      report_.computed += before - left.size();
      show(left.size());
      if (left.empty()) return;
      idle = left.size() == before ? idle + 1 : 0;
      if (idle == kIdleRounds) {
        fail(
            fmt::format("{} results are missing after {} array jobs in which nothing came; see "
                        "{}/slurm/*.log",
                        left.size(), kIdleRounds, request_.folder));
        return;
      }
      say(fmt::format("the array job left {} of {} results undone; they are submitted again",
                      left.size(), before));
      tasks = std::move(left);
    }
  }

  size_t undone(const std::vector<Task>& tasks) const {
    return static_cast<size_t>(std::count_if(tasks.begin(), tasks.end(), [&](const Task& t) {
      const PlannedPoint& p = table_.points[t.point];
      return !std::filesystem::exists(
          store_.path({table_.scenes[p.point.scene].hash, p.plan, t.seed}));
    }));
  }

  // Generation by generation: what the library proposes follows from the figures before it.
  void search() {
    uint32_t of_scene = 0;  // its first point
    for (size_t s = 0; s < scenes_.size(); of_scene += points_of_scene(study_, s), ++s) {
      if (!scenes_[s]) continue;
      uint32_t first = of_scene + points_of_scene(study_, s, false);
      for (const PointSet& set : study_.sets) {
        if (set.strategy != Strategy::kSearch || !set.has_scene(s)) continue;
        std::vector<std::vector<double>> told;
        for (int generation = 0; generation < set.generations; ++generation) {
          const std::vector<LineValues> proposed =
              next_generation(set, generation, told, request_.folder + "/search");
          std::vector<uint32_t> numbers;
          for (size_t i = 0; i < proposed.size(); ++i) {
            const auto number = static_cast<uint32_t>(
                first + static_cast<uint32_t>(generation * set.population) + i);
            PlannedPoint& p = table_.points[number];
            if (p.point.lines != proposed[i]) {
              p.point.lines = proposed[i];
              p.point.origin = fmt::format("search seed {}", set.seed);
              p.point.seeds = set.seeds;
              p.plan.clear();
              p.refused.clear();
              plans_[number].reset();
            }
            numbers.push_back(number);
          }
          plan_these(numbers);
          write_file(request_.folder + "/points.json", point_table_text(table_));
          measure_points(numbers);
          for (const uint32_t n : numbers) told.push_back(objectives_of(n, set));
        }
        first += static_cast<uint32_t>(set.population * set.generations);
      }
    }
  }

  std::vector<double> objectives_of(uint32_t number, const PointSet& set) {
    const PlannedPoint& p = table_.points[number];
    std::vector<Result> results;
    for (const uint64_t seed : seeds_of(p.point, study_.seeds))
      if (!p.plan.empty())
        if (auto r = store_.find({table_.scenes[p.point.scene].hash, p.plan, seed});
            r && stands(*r, *scenes_[p.point.scene]))
          results.push_back(std::move(*r));
    const Means means = means_of(results, {});
    std::vector<double> values;
    for (const std::string& name : set.objectives) {
      const auto m = means.find(name);
      if (m == means.end() || !std::isfinite(m->second.mean)) return {};
      values.push_back(m->second.mean);
    }
    return values;
  }

  const SweepRequest& request_;
  Study study_;
  ResultStore store_;
  std::vector<std::unique_ptr<StudyScene>> scenes_;  // null where one cannot be used
  PointTable table_;
  std::vector<std::optional<Plan>> plans_;  // by point, as far as they were made
  SweepReport report_;
  std::mutex mutex_;
};

}  // namespace

SweepReport run_sweep(const SweepRequest& request) {
  // In a new folder all points are missing. One that is there may have them all.
  if (request.on_slurm && !std::filesystem::exists(request.folder))
    if (const std::string why = slurm_missing(); !why.empty()) throw std::runtime_error(why);
  return Sweep(request).run();
}

}  // namespace photonloom
