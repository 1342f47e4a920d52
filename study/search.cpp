// SPDX-License-Identifier: Apache-2.0
#include "study/search.hpp"

#include <fmt/core.h>

#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "golden/numeric/output_file.hpp"
#include "study/points.hpp"

namespace photonloom {
namespace {

const char* const kProgram = PHOTONLOOM_SOURCE_DIR "/scripts/nsga2";

}  // namespace

std::string search_missing() {
  return std::system("python3 -c 'import optuna' >/dev/null 2>&1") == 0
             ? ""
             : "strategy search needs Optuna (Debian package python3-optuna), which python3 does "
               "not find here";
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
  if (std::system(fmt::format("python3 '{}' '{}' '{}'", kProgram, question, answer).c_str()) != 0)
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
