// SPDX-License-Identifier: Apache-2.0
// photonloom study NAME SCENE... -o DIR: shipped studies.
#include "command/study.hpp"

#include <fmt/core.h>
#include <sys/wait.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>
#include <stdexcept>

#include "command/command.hpp"
#include "command/console.hpp"
#include "command/tell.hpp"
#include "golden/numeric/output_file.hpp"
#include "golden/plan/toml.hpp"
#include "rtl/generate/data_files.hpp"
#include "study/measures.hpp"
#include "study/point_plan.hpp"
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
  if (std::filesystem::exists(name) && !std::filesystem::is_directory(name)) return name;
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

// A page and plots of another study would stand there beside figures that are none of theirs.
void check_pages(const std::string& folder, const ShippedStudy& study) {
  std::error_code error;
  for (const ShippedStudy& other : kStudies)
    if (const std::string page = fmt::format("{}/{}.md", folder, other.name);
        &other != &study && std::filesystem::exists(page, error))
      throw std::runtime_error(
          fmt::format("{}: is the page of study {}, expected a new folder, an empty one, or one of "
                      "study {} to go on with",
                      page, other.name, study.name));
}

// The file's study. Throws StudyError for one whose figures the study has nothing to say of.
Study read_needed(const ShippedStudy& study, const std::string& file) {
  Study asked = parse_study(read_file(file), file, measure_names());
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
    return asked;
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
    const int status = model_tools::run_shell(
        fmt::format("gnuplot -e {} {} >{}", quoted(terminal), quoted(file), quoted(drawn)));
    if (status != 0) {
      std::filesystem::remove(drawn);
      const bool is_missing = WIFEXITED(status) && WEXITSTATUS(status) == 127;
      tell("photonloom: {}: gnuplot did not draw it{}; the tables are whole\n", file,
           is_missing ? " (it is not there: Debian package gnuplot-nox)" : "");
      return false;
    }
  }
  return true;
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
  o.threads.apply();
  request.workers = o.threads.threads();
  request.work_dir = o.work;
  request.progress = progress.get();
  request.say = [](const std::string& sentence) { tell("photonloom: {}\n", sentence); };
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
  check_pages(o.output, study);
  std::vector<LineValues> bases;
  for (const std::string& file : files) bases.push_back(read_needed(study, file).base);
  for (size_t i = 0; i < files.size(); ++i) {
    const std::string& file = files[i];
    request.study_file = file;
    request.folder = o.output;
    if (files.size() > 1) request.folder += "/" + stem(file);
    const SweepReport r = run_sweep(request);
    fmt::print("{}: {} results computed, {} there before\n", request.folder, r.computed, r.kept);
    failures += r.failures.size();
    read_outcome(request.folder, bases[i], outcome);
  }
  Conclusion conclusion = study.conclude(outcome);
  const std::string page = fmt::format("{}/{}.md", o.output, study.name);
  const auto failed = [&](const std::string& more) {
    return CheckFailed(fmt::format("{} of scenes and points failed; what they said stands above{}",
                                   failures, more));
  };
  if (conclusion.rows == 0) {
    for (const std::string& sentence : conclusion.left_out)
      if (failures > 0 || conclusion.left_out.size() > 1) request.say(sentence);
    const std::string where = fmt::format("; the results stand in {}", o.output);
    if (failures > 0) throw failed(fmt::format("; {} is not written{}", page, where));
    if (!conclusion.left_out.empty())
      throw std::runtime_error(fmt::format(
          "{}: is not written: {}; expected a scene with figures that study {} concludes from{}",
          page,
          conclusion.left_out.size() > 1 ? "no scene has a row, as stands above"
                                         : conclusion.left_out.front(),
          study.name, where));
    throw std::runtime_error(fmt::format(
        "{}: is not written: no scene has the points that study {} concludes from, expected {} "
        "with all its [[points]]{}",
        page, study.name, files.front(), where));
  }
  bool has_plots = false;
  for (const Plot& plot : conclusion.plots) has_plots |= draw(o.output, plot);
  for (const Goal& goal : conclusion.goals) {
    const std::string line = fmt::format("{}: {:.4g}, goal {} {:.4g}{}", goal.text, goal.reached,
                                         goal.at_least ? "at least" : "at most", goal.wanted,
                                         goal.holds() ? "" : ": MISSED");
    fmt::print("{}\n", line);
    conclusion.page += "- " + line + "\n";
  }
  for (const std::string& sentence : conclusion.left_out) {
    request.say(sentence);
    conclusion.page += "- " + sentence + "\n";
  }
  write_file(page, conclusion.page);
  fmt::print("wrote {}{}, and {}/results.csv and summary.json\n", page, has_plots ? ", plots" : "",
             files.size() > 1 ? o.output + "/*" : o.output);
  if (failures > 0) throw failed("");
}

void add_study(CLI::App& app) {
  CLI::App* all = app.add_subcommand("study", "Shipped studies, measured and concluded");
  all->require_subcommand(1);
  const auto footer = [](const std::string& name) {
    return fmt::format(
        "A study (docs/studies.md) is a sweep of shipped study files, with tables, plots and "
        "goals.\n"
        "Stopped at any moment it goes on with the same command.\n\n"
        "Examples:\n"
        "  photonloom study {0} atrium cornell_balls -o build/studies/{0}",
        name);
  };
  all->footer(footer("reordering"));
  for (const ShippedStudy& study : kStudies) {
    auto o = std::make_shared<StudyOptions>();
    CLI::App* c = all->add_subcommand(study.name, study.summary);
    c->footer(footer(study.name));
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

const std::string& StudyRow::line(const std::string& name) const {
  const auto found = settings.find(name);
  if (found != settings.end()) return found->second;
  throw std::runtime_error(
      fmt::format("study {}, scene {}: a plan has no line {}, expected all", study, scene, name));
}

double StudyRow::number(const std::string& name) const { return std::stod(line(name)); }

std::string StudyRow::others(const std::vector<std::string>& but) const {
  std::string text;
  for (const auto& [name, value] : lines)
    if (std::find(but.begin(), but.end(), name) == but.end())
      text += fmt::format(", {} {}", name, value);
  return text;
}

std::string StudyRow::size() const {
  return fmt::format("{} × {}", line("frame.width"), line("frame.height"));
}

std::vector<const StudyRow*> rows_with(const std::vector<std::string>& columns, Figures wanted,
                                       const std::vector<const StudyRow*>& rows,
                                       Conclusion& conclusion) {
  std::vector<const StudyRow*> kept, all;
  std::copy_if(rows.begin(), rows.end(), std::back_inserter(all),
               [](const StudyRow* row) { return !row->is_baseline(); });
  std::string lacking;  // the first column that one has not
  for (const StudyRow* row : all) {
    const auto none = std::find_if(columns.begin(), columns.end(), [&](const std::string& name) {
      const double value = row->value(name);
      return !std::isfinite(value) || (wanted == Figures::kAboveZero && value <= 0);
    });
    if (none == columns.end())
      kept.push_back(row);
    else if (lacking.empty())
      lacking = *none;
  }
  if (kept.size() < all.size())
    conclusion.left_out.push_back(fmt::format(
        "study {}, scene {}: {} left out, {} has no {} there", all.front()->study,
        all.front()->scene,
        kept.empty() ? fmt::format("all {} points are", all.size())
                     : fmt::format("{} of {} points are", all.size() - kept.size(), all.size()),
        lacking, wanted == Figures::kAboveZero ? "figure above 0" : "finite figure"));
  return kept;
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

namespace {

// A plan file's lines, spelt as a study's.
std::map<std::string, std::string> plan_lines(const std::string& file) {
  std::map<std::string, std::string> lines;
  const toml::table plan = parse_toml(read_file(file), file);
  for (const auto& [section, keys] : plan)
    if (const toml::table* table = keys.as_table())
      for (const auto& [key, value] : *table)
        lines[fmt::format("{}.{}", section.str(), key.str())] = value_text(value);
  return lines;
}

}  // namespace

void read_outcome(const std::string& folder, const LineValues& base, StudyOutcome& outcome) {
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
    row.settings =
        plan_lines(fmt::format("{}/plans/{}.toml", folder, point.at("plan").get<std::string>()));
    LineValues own;
    for (const auto& [names, value] : point.at("lines").items())
      own.emplace_back(names, value.get<std::string>());
    for (const auto& [name, value] : joined_lines({}, own)) row.lines[name] = value;
    for (const auto& [name, value] : joined_lines(base, own)) row.settings[name] = value;
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
