// SPDX-License-Identifier: Apache-2.0
// What `photonloom study sampling` and `photonloom study adaptive` say: final gather rays for equal
// noise, and whether the light is the same. docs/sampling.md defines it, docs/studies.md has the
// figures.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "command/ray_curves.hpp"
#include "command/study.hpp"

namespace photonloom {
namespace {

constexpr double kRays = 16;      // of the baseline that others are compared with
constexpr double kManyRays = 64;  // likewise, where rare bright rays are met more often
constexpr double kShadowBaseline = 8;
// Scenes whose indirect light is concentrated: through a doorway, and from a pool's caustics.
const std::vector<std::string> kConcentrated = {"doorway", "water_pool"};

// Columns of the tables.
std::string combination(const StudyRow& row) {
  const std::string& combine = row.line("sampler.combine");
  const std::string others =
      row.others({"frame.gather_rays", "sampler.combine", "sampler.levels", "frame.table_photons"});
  if (combine == "cosine") return "cosine | – | –" + others;
  return fmt::format("{} | {} | {}{}", combine, row.line("sampler.levels"),
                     row.line("frame.table_photons"), others);
}
std::string pass_name(const StudyRow& row, const RayKind& kind) {
  const std::string& first = row.line(kind.first);
  return (first == "0" ? "one pass" : fmt::format("two passes, the first of {}", first)) +
         row.others({kind.first, kind.mean, kind.fixed});
}
std::string passes(const StudyRow& row) { return pass_name(row, kGatherRays); }
std::string shadow_passes(const StudyRow& row) { return pass_name(row, kAllShadowRays); }

// Names of rows in the order in which they come.
template <class Name>
std::vector<std::string> names_of(const std::vector<const StudyRow*>& rows, const Name& name) {
  std::vector<std::string> names;
  for (const StudyRow* row : rows)
    if (std::find(names.begin(), names.end(), name(*row)) == names.end())
      names.push_back(name(*row));
  return names;
}

// A study's rows that have noise, scene by scene.
std::vector<const StudyRow*> noisy_rows(const StudyOutcome& outcome, const std::string& study,
                                        const RayKind& kind, Conclusion& conclusion) {
  std::vector<const StudyRow*> all;
  for (const std::string& scene : outcome.scenes) {
    const auto rows = rows_with(
        {fmt::format("{}.{}", kind.measure, kind.rays), fmt::format("{}.relmse", kind.measure)},
        Figures::kAboveZero, outcome.rows_of(study, scene), conclusion);
    all.insert(all.end(), rows.begin(), rows.end());
  }
  return all;
}

// What settings are compared and goals judged by: a part that is known as too large only reaches
// none.
double judged(const RayPart& part) {
  return part.beyond > 0 ? std::numeric_limits<double>::infinity() : part.value;
}
// Of a goal's figure: "± 0.03", or on which side of it the part lies.
std::string doubt(const RayPart& part) {
  if (part.beyond != 0) return part.beyond > 0 ? "more than was measured" : "at most";
  return fmt::format("± {:.2g}", part.error);
}

struct RowCurves {
  std::string name;                // of a row
  std::vector<RayCurve> by_scene;  // of those with curves
  std::vector<RayPart> parts;
};

// Rays for equal noise, a row a name and a column a scene; the first name is the baseline.
template <class Name>
std::vector<RowCurves> part_table(const std::vector<const StudyRow*>& points, const RayKind& kind,
                                  double rays, const Name& name, const std::string& heads,
                                  std::string& page, std::vector<std::string>& scenes) {
  std::vector<RowCurves> rows;
  for (const StudyRow* point : points)
    if (std::find(scenes.begin(), scenes.end(), point->scene) == scenes.end())
      scenes.push_back(point->scene);
  for (const std::string& row : names_of(points, name)) {
    rows.push_back({row, {}, {}});
    for (const std::string& scene : scenes) {
      std::vector<const StudyRow*> here;
      std::copy_if(points.begin(), points.end(), std::back_inserter(here),
                   [&](const StudyRow* r) { return r->scene == scene && name(*r) == row; });
      rows.back().by_scene.emplace_back(row, here, kind);
    }
  }
  if (rows.empty()) return rows;
  page += "| " + heads + " |";
  for (const std::string& scene : scenes) page += " " + scene + " |";
  page += "\n|---";
  for (size_t i = 0;
       i < scenes.size() + static_cast<size_t>(std::count(heads.begin(), heads.end(), '|')); ++i)
    page += "|---";
  page += "|\n";
  for (RowCurves& row : rows) {
    page += "| " + row.name + " |";
    for (size_t s = 0; s < scenes.size(); ++s) {
      row.parts.push_back(row.by_scene[s].part_of(rows.front().by_scene[s], rays));
      page += &row == &rows.front() ? " 1 |" : " " + text_of(row.parts.back()) + " |";
    }
    page += "\n";
  }
  page += "\n";
  return rows;
}

// Adds a plot a scene of the rows of a table.
void plot_rows(const std::string& study, const RayKind& kind,
               const std::vector<std::string>& scenes, const std::vector<RowCurves>& rows,
               std::vector<Plot>& to) {
  for (size_t s = 0; s < scenes.size(); ++s) {
    std::vector<RayCurve> curves;
    for (const RowCurves& row : rows) curves.push_back(row.by_scene[s]);
    to.push_back(plot_curves(
        fmt::format("{}_{}{}", study, scenes[s],
                    std::string_view(kind.rays) == "rays" ? "" : fmt::format("_{}", kind.rays)),
        fmt::format("{}: noise of {}", scenes[s], kind.name), kind, curves));
  }
}

std::string seeds_text(const StudyOutcome& outcome, const std::string& study) {
  std::string text;
  const auto found = outcome.seeds.find(study);
  if (found == outcome.seeds.end()) return "none";
  for (const uint64_t seed : found->second)
    text += fmt::format("{}{}", text.empty() ? "" : ", ", seed);
  return text;
}

// The measure `ray_means`; adds the goals that |z| of an image stays below 3. Of several seeds,
// each with photons of its own, z is that of all together (Stouffer: the sum of their z over the
// root of their number); blocks are left out, as each seed has another farthest one. The title, if
// there is one, stands above the table with the seeds.
template <class Name>
void means_table(const StudyOutcome& outcome, const std::string& study, const std::string& title,
                 const Name& name, const std::string& heads, Conclusion& conclusion) {
  const auto seeds_of = outcome.seeds.find(study);
  const size_t seeds = seeds_of == outcome.seeds.end() ? 0 : seeds_of->second.size();
  const double root = std::sqrt(static_cast<double>(seeds));
  std::string table;
  for (const std::string& scene : outcome.scenes) {
    double farthest = 0, saturated = 0;
    size_t rows = 0;
    for (const StudyRow* row :
         rows_with({"ray_means.z", "ray_means.bias", "ray_means.bias_error", "ray_means.saturated"},
                   Figures::kFinite, outcome.rows_of(study, scene), conclusion)) {
      const auto value = [&](const char* column) {
        return row->value(std::string("ray_means.") + column);
      };
      const double z = value("z") * root;
      table += fmt::format("| {} | {} | {} | {:+.2f} ± {:.2f} % | {:+.2f} |", scene, name(*row),
                           asked_rays(*row, kGatherRays), 100 * value("bias"),
                           100 * value("bias_error") / root, z);
      if (seeds == 1) table += fmt::format(" {:+.2f} | {:.1f} |", value("worst_z"), value("chi2"));
      table += "\n";
      if (std::fabs(z) > std::fabs(farthest)) farthest = z;
      saturated += value("saturated");
      ++rows;
    }
    if (rows == 0) continue;
    conclusion.rows += rows;
    conclusion.goals.push_back(
        {fmt::format("{}: farthest mean over {}64 ray seeds, of {} settings, in standard errors",
                     scene, seeds == 1 ? "" : fmt::format("{} × ", seeds), rows),
         3, std::fabs(farthest), false});
    conclusion.goals.push_back({scene + ": values that did not fit a pixel", 0, saturated, false});
  }
  if (table.empty()) return;
  std::string head =
      fmt::format("| scene | {} | rays | light over the cosine's, minus 1 | z |", heads);
  if (seeds == 1) head += " farthest z of 16 blocks | Σ z² of 16 blocks |";
  if (!title.empty())
    conclusion.page += fmt::format("{}; seeds {} together:\n\n", title, seeds_text(outcome, study));
  std::string rule;
  for (int64_t i = std::count(head.begin(), head.end(), '|'); i > 1; --i) rule += "|---";
  conclusion.page += fmt::format("{}\n{}|\n{}\n", head, rule, table);
}

// A table of two passes beside one, and as goals the best two scenes of the one setting whose
// second best scene is best.
template <class Name>
void compare_passes(const std::vector<const StudyRow*>& points, const std::string& study,
                    const RayKind& kind, double rays, const Name& name, Conclusion& conclusion) {
  std::vector<std::string> scenes;
  const std::vector<RowCurves> rows =
      part_table(points, kind, rays, name, "frame", conclusion.page, scenes);
  conclusion.rows += rows.size();
  plot_rows(study, kind, scenes, rows, conclusion.plots);
  const RowCurves* best = nullptr;
  std::vector<size_t> order;
  for (size_t r = 1; r < rows.size(); ++r) {
    std::vector<size_t> by_part;
    for (size_t s = 0; s < scenes.size(); ++s)
      if (std::isfinite(rows[r].parts[s].value)) by_part.push_back(s);
    std::sort(by_part.begin(), by_part.end(), [&](size_t a, size_t b) {
      return judged(rows[r].parts[a]) < judged(rows[r].parts[b]);
    });
    if (by_part.size() < 2) continue;
    if (!best || judged(rows[r].parts[by_part[1]]) < judged(best->parts[order[1]])) {
      best = &rows[r];
      order = by_part;
    }
  }
  if (best)
    for (const size_t i : {0, 1})
      conclusion.goals.push_back(
          {fmt::format("{}, {}: part of the {} of one pass, {}", scenes[order[i]], best->name,
                       kind.name, doubt(best->parts[order[i]])),
           0.7, judged(best->parts[order[i]]), false});
}

// Rays of each combination for the noise that so many cosine-sampled rays leave; as goals the one
// setting that comes nearest to its goals in all scenes, and where light is concentrated the best.
void compare_combinations(const StudyOutcome& outcome, const std::vector<const StudyRow*>& points,
                          double rays, Conclusion& conclusion) {
  conclusion.page += fmt::format(
      "Rays for the noise that {:g} cosine-sampled rays leave, as a part of those {:g}; seeds "
      "{}:\n\n",
      rays, rays, seeds_text(outcome, "sampling"));
  std::vector<std::string> scenes;
  const std::vector<RowCurves> rows =
      part_table(points, kGatherRays, rays, combination, "combine | levels | photons",
                 conclusion.page, scenes);
  conclusion.rows += rows.size();
  if (rays == kRays) plot_rows("sampling", kGatherRays, scenes, rows, conclusion.plots);
  const auto concentrated = [&](size_t scene) {
    return std::find(kConcentrated.begin(), kConcentrated.end(), scenes[scene]) !=
           kConcentrated.end();
  };
  const auto goal_of = [&](size_t scene) { return concentrated(scene) ? 0.5 : 1.05; };
  const auto add_goal = [&](size_t scene, const char* which, const RowCurves& row) {
    conclusion.goals.push_back(
        {fmt::format("{}, {:g} rays{}, {}: part of the cosine's rays, {}", scenes[scene], rays,
                     which, row.name, doubt(row.parts[scene])),
         goal_of(scene), judged(row.parts[scene]), false});
  };
  const RowCurves* best = nullptr;
  double least = 0;
  for (size_t r = 1; r < rows.size(); ++r) {
    double farthest = 0;
    bool everywhere = true;
    for (size_t s = 0; s < scenes.size(); ++s) {
      everywhere = everywhere && std::isfinite(rows[r].parts[s].value);
      farthest = std::max(farthest, judged(rows[r].parts[s]) / goal_of(s));
    }
    if (everywhere && (!best || farthest < least)) {
      best = &rows[r];
      least = farthest;
    }
  }
  if (best)
    for (size_t s = 0; s < scenes.size(); ++s) add_goal(s, "", *best);
  for (size_t s = 0; s < scenes.size(); ++s) {
    const auto least_of =
        std::min_element(rows.begin(), rows.end(), [&](const RowCurves& a, const RowCurves& b) {
          return judged(a.parts[s]) < judged(b.parts[s]);
        });
    if (least_of != rows.end() && concentrated(s)) add_goal(s, ", its own best", *least_of);
  }
}

}  // namespace

Conclusion conclude_sampling(const StudyOutcome& outcome) {
  Conclusion conclusion;
  const auto points = noisy_rows(outcome, "sampling", kGatherRays, conclusion);
  if (!points.empty())
    for (const double rays : {kRays, kManyRays})
      compare_combinations(outcome, points, rays, conclusion);
  means_table(outcome, "sampling_means", "", combination, "combine | levels | photons", conclusion);
  means_table(outcome, "sampling_again", "The same with other photons", combination,
              "combine | levels | photons", conclusion);
  return conclusion;
}

Conclusion conclude_adaptive(const StudyOutcome& outcome) {
  Conclusion conclusion;
  if (const auto points = noisy_rows(outcome, "adaptive", kGatherRays, conclusion);
      !points.empty()) {
    conclusion.page = fmt::format(
        "Rays for the noise that one pass of {:g} rays leaves, as a part of those {:g}; seeds "
        "{}:\n\n",
        kRays, kRays, seeds_text(outcome, "adaptive"));
    compare_passes(points, "adaptive", kGatherRays, kRays, passes, conclusion);
  }
  means_table(outcome, "adaptive_means", "", passes, "frame", conclusion);
  for (const RayKind* kind : {&kAllShadowRays, &kEmitterRays}) {
    const auto points = noisy_rows(outcome, "adaptive_shadows", *kind, conclusion);
    if (points.empty()) continue;
    conclusion.page += fmt::format(
        "Rays for the noise of direct light that one pass of {:g} shadow rays of each kind leaves, "
        "as a part of those that it casts; {}; seeds {}:\n\n",
        kShadowBaseline, kind == &kEmitterRays ? "rays towards emitters alone" : "both kinds",
        seeds_text(outcome, "adaptive_shadows"));
    compare_passes(points, "adaptive_shadows", *kind, kShadowBaseline, shadow_passes, conclusion);
  }
  return conclusion;
}

}  // namespace photonloom
