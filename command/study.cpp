// SPDX-License-Identifier: Apache-2.0
// photonloom study NAME SCENE... -o DIR: shipped studies.
#include "command/study.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <stdexcept>

#include "command/command.hpp"
#include "command/console.hpp"
#include "golden/numeric/output_file.hpp"
#include "rtl/generate/data_files.hpp"
#include "study/measures.hpp"
#include "study/runner.hpp"
#include "study/store.hpp"
#include "study/study_file.hpp"
#include "verilator_tb/model/tools.hpp"

namespace photonloom {
namespace {

struct ShippedStudy {
  const char* name;
  const char* summary;
  std::vector<std::string> files;  // studies/FILE.toml
  // Measures that it concludes from, by the name of the study that has them; "": any name.
  std::vector<std::pair<std::string, std::vector<std::string>>> needed;
  Conclusion (*conclude)(const StudyOutcome&);
};
const ShippedStudy kStudies[] = {
    {"reordering",
     "Bytes from the photon map in every order of the final gathers",
     {"reordering"},
     {{"", {"traffic"}}},
     conclude_reordering},
    {"layouts",
     "Bytes from the photon map in other layouts, compressed lines among them",
     {"layouts"},
     {{"", {"layouts"}}},
     conclude_layouts},
    {"caching",
     "Final gathers that an irradiance cache avoids, and the error it adds",
     {"caching", "caching_converged"},
     {{"caching", {"caching"}}, {"caching_converged", {"caching", "visible"}}},
     conclude_caching},
    {"sampling",
     "Final gather rays that the sampler's tables save, and whether their light is the same",
     {"sampling", "sampling_means", "sampling_again"},
     {{"sampling", {"noise"}},
      {"sampling_means", {"ray_means"}},
      {"sampling_again", {"ray_means"}}},
     conclude_sampling},
    {"adaptive",
     "Final gather rays that two passes save",
     {"adaptive", "adaptive_means", "adaptive_shadows"},
     {{"adaptive", {"noise"}},
      {"adaptive_means", {"ray_means"}},
      {"adaptive_shadows", {"shadows"}}},
     conclude_adaptive},
    {"system",
     "Units, memory and area that the dissertation's load would take",
     {"system"},
     {{"system", {"gather", "resources"}}},
     conclude_system},
};

struct StudyOptions {
  std::vector<std::string> scenes, files;
  std::string output, work = "build/cosim";
  bool wait = false;
  ThreadsOption threads;
};

// A scene's file: as given, or the shipped scene of that name.
std::string scene_file(const std::string& name) {
  if (std::filesystem::exists(name)) return name;
  const std::string shipped = data_dir() + "/scenes/" + name + ".xml";
  if (std::filesystem::exists(shipped)) return shipped;
  throw UsageError(fmt::format("SCENE '{}': expected a file, or the name of one in {}/scenes", name,
                               data_dir()));
}

std::string stem(const std::string& file) { return std::filesystem::path(file).stem().string(); }

// A folder that holds the sweeps of several files, each in a folder of its own.
void check_folder(const std::string& folder, const std::vector<std::string>& files) {
  std::error_code error;
  if (!std::filesystem::exists(folder, error)) return;
  if (!std::filesystem::is_directory(folder, error))
    throw std::runtime_error(
        fmt::format("{}: is not a folder, expected a new one or a study's", folder));
  if (std::filesystem::is_empty(folder, error)) return;
  std::string names;
  for (const std::string& file : files) {
    if (std::filesystem::is_directory(folder + "/" + stem(file), error)) return;
    names += (names.empty() ? "" : ", ") + stem(file);
  }
  throw std::runtime_error(
      fmt::format("{}: is no study's folder: it holds files but none of {}, expected a new folder, "
                  "an empty one, or a study's to go on with",
                  folder, names));
}

// Throws StudyError for a file whose figures the study has nothing to say of.
void check_needed(const ShippedStudy& study, const std::string& file) {
  const Study asked = parse_study(read_file(file), file, measure_names());
  std::string names;
  for (const auto& [name, measures] : study.needed) {
    names += (names.empty() ? "" : ", ") + name;
    if (!name.empty() && name != asked.name) continue;
    for (const std::string& m : measures)
      if (std::find(asked.measures.begin(), asked.measures.end(), m) == asked.measures.end())
        throw StudyError(
            fmt::format("{}: study.measure has no \"{}\", expected it, as study {} "
                        "concludes from it",
                        file, m, study.name));
    return;
  }
  throw StudyError(
      fmt::format("{}: study.name is {}, expected one of {}, by which study {} knows "
                  "its figures",
                  file, asked.name, names, study.name));
}

// Whether it was drawn; says so where it was not, and leaves the commands.
bool draw(const std::string& folder, const Plot& plot) {
  // Absolute, as no name then begins with '-'.
  const std::string beside = std::filesystem::absolute(folder) / plot.name, file = beside + ".gp";
  write_file(file, plot.commands);
  using model_tools::quoted;
  for (const char* kind : {"svg", "png"}) {
    const std::string terminal = fmt::format("set terminal {} size {},{} background \"white\"",
                                             kind, plot.width, plot.height),
                      drawn = fmt::format("{}.{}", beside, kind);
    if (std::system(
            fmt::format("gnuplot -e {} {} >{}", quoted(terminal), quoted(file), quoted(drawn))
                .c_str()) != 0) {
      std::filesystem::remove(drawn);
      fmt::print(stderr,
                 "photonloom: {}: gnuplot did not draw it (Debian package gnuplot-nox); the tables "
                 "are whole\n",
                 file);
      return false;
    }
  }
  return true;
}

// Whether one of a page's tables has more than its head.
bool has_table_row(const std::string& page) {
  std::istringstream lines(page);
  bool after_head = false;
  for (std::string line; std::getline(lines, line);) {
    if (after_head && line.starts_with("|")) return true;
    after_head = line.starts_with("|---");
  }
  return false;
}

// Every file's folder is DIR, or where a study has several DIR/FILE.
void run_study(const ShippedStudy& study, const StudyOptions& o) {
  const std::unique_ptr<Progress> progress = make_progress_or_log();
  std::vector<std::string> files = o.files;
  if (files.empty())
    for (const std::string& file : study.files)
      files.push_back(fmt::format("{}/studies/{}.toml", data_dir(), file));
  SweepRequest request;
  for (const std::string& scene : o.scenes) request.scenes.push_back(scene_file(scene));
  request.wait = o.wait;
  request.workers = o.threads.threads();
  request.work_dir = o.work;
  request.progress = progress.get();
  request.say = [](const std::string& sentence) {
    fmt::print(stderr, "photonloom: {}\n", sentence);
  };
  StudyOutcome outcome;
  size_t failures = 0;
  std::set<std::string> stems;
  for (const std::string& file : files)
    if (!stems.insert(stem(file)).second)
      throw StudyError(
          fmt::format("--study {}: a study file of the name {} is there already, and each has the "
                      "folder of its name; expected different names",
                      file, stem(file)));
  if (files.size() > 1)
    check_folder(o.output, files);
  else
    check_sweep_folder(o.output);
  for (const std::string& file : files) check_needed(study, file);
  for (const std::string& file : files) {
    request.study_file = file;
    request.folder = o.output;
    if (files.size() > 1) request.folder += "/" + stem(file);
    const SweepReport r = run_sweep(request);
    fmt::print("{}: {} results computed, {} there before\n", request.folder, r.computed, r.kept);
    failures += r.failures.size();
    read_outcome(request.folder, outcome);
  }
  Conclusion conclusion = study.conclude(outcome);
  if (!has_table_row(conclusion.page))
    throw std::runtime_error(fmt::format(
        "{}/{}.md: is not written: no scene has the points that study {} concludes from, expected "
        "{} with all its [[points]]; the results stand in {}",
        o.output, study.name, study.name, files.front(), o.output));
  bool has_plots = false;
  for (const Plot& plot : conclusion.plots) has_plots |= draw(o.output, plot);
  for (const Goal& goal : conclusion.goals) {
    const std::string line = fmt::format("{}: {:.4g}, goal {} {:.4g}{}", goal.text, goal.reached,
                                         goal.at_least ? "at least" : "at most", goal.wanted,
                                         goal.holds() ? "" : ": MISSED");
    fmt::print("{}\n", line);
    conclusion.page += "- " + line + "\n";
  }
  write_file(fmt::format("{}/{}.md", o.output, study.name), conclusion.page);
  fmt::print("wrote {}/{}.md{}, and {}/results.csv and summary.json\n", o.output, study.name,
             has_plots ? ", plots" : "", files.size() > 1 ? o.output + "/*" : o.output);
  if (failures > 0)
    throw CheckFailed(
        fmt::format("{} of scenes and points failed; what they said stands above", failures));
}

void add_study(CLI::App& app) {
  CLI::App* all = app.add_subcommand("study", "Shipped studies, measured and concluded");
  all->require_subcommand(1);
  all->footer(
      "A study (docs/studies.md) is a sweep of shipped study files, with tables, plots and goals.\n"
      "Stopped at any moment it goes on with the same command.\n\n"
      "Examples:\n"
      "  photonloom study reordering atrium cornell_balls -o build/studies/reordering");
  for (const ShippedStudy& study : kStudies) {
    auto o = std::make_shared<StudyOptions>();
    CLI::App* c = all->add_subcommand(study.name, study.summary);
    c->add_option("SCENE", o->scenes,
                  "Scene files or names of shipped scenes (default: the study's)");
    c->add_option("-o,--output", o->output, "The study's folder, new or to go on with")
        ->required()
        ->type_name("DIR");
    c->add_option("--study", o->files, "Study files instead of the shipped ones, each by its name")
        ->type_name("STUDY.toml")
        ->expected(1)
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
    c->add_flag("--wait", o->wait, "Wait for another study on the folder instead of refusing");
    c->add_option("--work", o->work, "Folder of Verilated models (default build/cosim)")
        ->type_name("DIR");
    o->threads.add_to(*c);
    c->callback([o, &study] { run_study(study, *o); });
  }
}

const Command study_command(47, add_study);

}  // namespace

std::string StudyRow::line(const std::string& name, const std::string& otherwise) const {
  const auto found = lines.find(name);
  return found == lines.end() ? otherwise : found->second;
}

namespace {

double column(const StudyRow& row, const std::map<std::string, double>& columns,
              const std::string& name) {
  const auto found = columns.find(name);
  if (found != columns.end()) return found->second;
  throw std::runtime_error(
      fmt::format("study {}, scene {}: the results have no column {}; expected measure \"{}\" in "
                  "the study's file",
                  row.study, row.scene, name, name.substr(0, name.find('.'))));
}

}  // namespace

double StudyRow::value(const std::string& name) const { return column(*this, values, name); }
double StudyRow::error(const std::string& name) const { return column(*this, errors, name); }

std::vector<const StudyRow*> StudyOutcome::rows_of(const std::string& study,
                                                   const std::string& scene) const {
  std::vector<const StudyRow*> found;
  for (const StudyRow& row : rows)
    if (row.study == study && row.scene == scene) found.push_back(&row);
  return found;
}

void read_outcome(const std::string& folder, StudyOutcome& outcome) {
  const nlohmann::json summary = nlohmann::json::parse(read_file(folder + "/summary.json"));
  outcome.seeds[summary.at("study").get<std::string>()] =
      summary.at("seeds").get<std::vector<uint64_t>>();
  for (const auto& scene : summary.at("scenes")) {
    const auto name = scene.at("scene").get<std::string>();
    if (std::find(outcome.scenes.begin(), outcome.scenes.end(), name) == outcome.scenes.end())
      outcome.scenes.push_back(name);
  }
  const auto number = [](const nlohmann::json& value) {
    return value.is_null() ? std::numeric_limits<double>::quiet_NaN() : value.get<double>();
  };
  for (const auto& point : summary.at("points")) {
    if (point.at("state") != "done") continue;
    StudyRow row;
    row.study = summary.at("study").get<std::string>();
    row.scene = point.at("scene").get<std::string>();
    for (const auto& [line, value] : point.at("lines").items())
      row.lines[line] = value.get<std::string>();
    for (const auto& [name, value] : point.at("values").items()) {
      row.values[name] = number(value.at("mean"));
      row.errors[name] = number(value.at("error"));
    }
    outcome.rows.push_back(std::move(row));
  }
}

std::string gnuplot_text(const std::string& text) {
  std::string out = "'";
  for (const char c : text)
    out += c == '\'' ? "''" : std::string(1, static_cast<unsigned char>(c) < 0x20 ? ' ' : c);
  return out + "'";
}

}  // namespace photonloom
