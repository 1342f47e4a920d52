// SPDX-License-Identifier: Apache-2.0
#include "study/search.hpp"

#include <fmt/core.h>

#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "golden/numeric/output_file.hpp"
#include "study/points.hpp"
#include "verilator_tb/model/tools.hpp"

namespace photonloom {
namespace {

const char* const kProgram = PHOTONLOOM_SOURCE_DIR "/scripts/nsga2";

// The Python that has the library: the user's, else the system's, for which Debian packages it.
// Empty: none.
std::string python() {
  for (const char* candidate : {"python3", "/usr/bin/python3"})
    if (model_tools::run_shell(fmt::format("{} -c 'import optuna' >/dev/null 2>&1", candidate)) ==
        0)
      return candidate;
  return {};
}

}  // namespace

std::string search_missing() {
  return python().empty() ? "strategy search needs Optuna (Debian package python3-optuna; make "
                            "sweep-search installs it), which no python3 here finds"
                          : "";
}

std::vector<LineValues> next_generation(const PointSet& set, int generation,
                                        const std::vector<std::vector<double>>& objectives,
                                        const std::string& folder) {
  std::filesystem::create_directories(folder);
  const std::string question = folder + "/question.json", answer = folder + "/answer.json";
  const nlohmann::json j = {{"seed", set.seed},
                            {"population", set.population},
                            {"generation", generation},
                            {"dimensions", set.choices.size()},
                            {"objectives", set.objectives.size()},
                            {"told", objectives}};
  write_file(question, j.dump() + "\n");
  std::filesystem::remove(answer);
  using model_tools::quoted;
  if (model_tools::run_shell(fmt::format("{} {} {} {}", python(), quoted(kProgram),
                                         quoted(question), quoted(answer))) != 0)
    throw std::runtime_error("scripts/nsga2 failed; see its message above");
  std::vector<LineValues> points;
  for (const auto& place : nlohmann::json::parse(read_file(answer))) {
    LineValues lines;
    for (size_t d = 0; d < set.choices.size(); ++d)
      lines.emplace_back(set.choices[d].line, value_at(set.choices[d], place.at(d)));
    points.push_back(lines);
  }
  return points;
}

}  // namespace photonloom
