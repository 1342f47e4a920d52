// SPDX-License-Identifier: Apache-2.0
// Shipped studies: photonloom study NAME runs the files of studies/ that belong to it and says what
// their figures mean. A further study is a file there, a conclusion here, and a row of the list in
// study.cpp.
#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "study/study_file.hpp"

namespace photonloom {

// A point with figures, as summary.json has it.
struct StudyRow {
  std::string study;  // the name that its file has
  std::string scene;
  std::map<std::string, std::string> lines;     // set in this point, beyond the study's base
  std::map<std::string, std::string> settings;  // all: these, the base's, and the plan's others
  std::map<std::string, double> values;  // "measure.column": the mean; NaN where there is none
  std::map<std::string, double> errors;  // their standard errors

  bool is_baseline() const { return lines.empty(); }
  // The line's value, wherever it is set; a std::runtime_error for a name that is no line.
  const std::string& line(const std::string& name) const;
  double number(const std::string& name) const;
  // Lines of its own but these: ", frame.tile 8"; empty where there is none.
  std::string others(const std::vector<std::string>& but) const;
  // "256 × 256".
  std::string size() const;
  // Of a column that the study measured; a std::runtime_error for others.
  double value(const std::string& name) const;
  double error(const std::string& name) const;
};

struct StudyOutcome {
  std::vector<std::string> scenes;
  std::map<std::string, std::vector<uint64_t>> seeds;  // by the name that a file has
  std::vector<StudyRow> rows;                          // of all files

  std::vector<const StudyRow*> rows_of(const std::string& study, const std::string& scene) const;
};
// Adds what the folder of a finished file with this base holds.
void read_outcome(const std::string& folder, const LineValues& base, StudyOutcome& outcome);

// What a study set out to reach; printed with what was reached, and MISSED where it was not.
struct Goal {
  std::string text;  // "atrium, at most 1 MB of buffer: gain"
  double wanted = 0, reached = 0;
  bool at_least = true;
  bool holds() const { return at_least ? reached >= wanted : reached <= wanted; }
};

// Drawn by gnuplot: NAME.gp with the commands, NAME.svg, NAME.png.
struct Plot {
  std::string name, commands;
  int width = 0, height = 0;
};
// A text of such commands, quotes included: within single quotes gnuplot runs nothing.
std::string gnuplot_text(const std::string& text);

// What a study's figures say: tables as Markdown, and the goals and plots of the scenes that are
// there.
struct Conclusion {
  std::string page;
  size_t rows = 0;                    // of the tables
  std::vector<std::string> left_out;  // what they do not hold, and why: a sentence each
  std::vector<Goal> goals;
  std::vector<Plot> plots;
};

enum class Figures { kFinite, kAboveZero };
// Rows of a scene that have such figures in all these columns, its baseline left aside. That others
// are left out is said in the conclusion.
std::vector<const StudyRow*> rows_with(const std::vector<std::string>& columns, Figures wanted,
                                       const std::vector<const StudyRow*>& rows,
                                       Conclusion& conclusion);

Conclusion conclude_reordering(const StudyOutcome& outcome);
Conclusion conclude_layouts(const StudyOutcome& outcome);
Conclusion conclude_caching(const StudyOutcome& outcome);
Conclusion conclude_sampling(const StudyOutcome& outcome);
Conclusion conclude_adaptive(const StudyOutcome& outcome);
Conclusion conclude_system(const StudyOutcome& outcome);

}  // namespace photonloom
