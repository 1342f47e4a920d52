// SPDX-License-Identifier: Apache-2.0
// The study file: which plans of which scenes are measured, how, and with which seeds. Its format
// stands in docs/sweep.md.
#pragma once
#include <cstdint>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "golden/plan/toml.hpp"

namespace photonloom {

// What is wrong with a study: one sentence with file, line, key, and what was expected.
struct StudyError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// Points asked for that the study does not have; the sentence names the option.
struct PointsError : StudyError {
  using StudyError::StudyError;
};

// Lines set in a point, (name, value as in a plan file), in the file's order. A name is
// section.key of the plan, several of them joined by '+', or one of the study's own (kStudyLines).
using LineValues = std::vector<std::pair<std::string, std::string>>;
// A value as a plan's line takes it: without quotes, an integer in decimal digits whatever it is
// written in. Messages have toml_text, which shows both.
std::string value_text(const toml::node& node);

// What a study sets beside the plan's lines.
inline constexpr const char* kStudyLines[] = {"photons", "caustic_photons", "radius_scale",
                                              "packed"};

// Values that a line may take: those of a list, or numbers of a range.
struct LineChoice {
  std::string line;
  std::vector<std::string> values;  // empty: a range
  double from = 0, to = 0;          // inclusive
  bool whole = false;               // integers alone, as the line has
  bool logarithmic = false;
};

enum class Strategy { kList, kGrid, kLatinHypercube, kSearch };

// Points of a study at most, of all its scenes together.
inline constexpr uint32_t kMostPoints = 1000000;

// One [[points]] of the file.
struct PointSet {
  Strategy strategy = Strategy::kList;
  int line = 0;                  // of the file
  std::vector<LineValues> list;  // of kList
  std::vector<LineChoice> choices;
  int count = 0;                        // of kLatinHypercube
  uint64_t seed = 1;                    // of kLatinHypercube and kSearch
  int population = 0, generations = 0;  // of kSearch
  std::vector<std::string> objectives;  // "measure.column", all minimised
  int seeds = 0;                        // so many first ones of the study's; 0: all
  std::vector<size_t> scenes;           // of the study's, ascending; empty: all

  bool has_scene(size_t scene) const;
  // How many there are in each of its scenes. Beyond kMostPoints any number may stand for it.
  uint64_t points() const;
};

struct Study {
  std::string file, name;
  std::string text;                 // of the file
  std::vector<std::string> scenes;  // paths
  std::vector<uint64_t> seeds;
  int width = 64, height = 64;
  // Not 0: what is measured is one pixel of each of width x height parts of a frame of this size
  // (struct Film). No key of the file.
  int frame_width = 0, frame_height = 0;
  std::vector<std::string> measures;
  int reference_spp = 0;        // of each of two references that no file gives; 0: none is made
  std::string reference_files;  // path with {scene} and {n}; empty: none
  bool rtl_cycles = false;
  int gather_queries = 2048, latency = 60;
  // Measures that are taken with so many first seeds alone, by name; all others with all seeds.
  std::map<std::string, int> first_seeds;
  LineValues base;
  std::vector<PointSet> sets;

  std::string referenced() const;  // the first measure that needs references; empty: none does
};

// Takes these scenes instead of the study's. Points of some scenes only keep to those of the same
// names; returns a sentence for each [[points]] that has none of them and goes. Throws StudyError
// for two scenes of one name and for too many points.
std::vector<std::string> replace_scenes(Study& study, const std::vector<std::string>& files);

// Why no plan can have this value in these lines, a name of LineValues; empty: one may. The frame's
// size is no line of theirs: `size` is what decides it.
std::string line_problem(const std::string& names, const std::string& value,
                         const std::string& size);

// Throws StudyError. `measures` are the names that [study] measure may hold, each with the columns
// that an objective may name.
Study parse_study(const std::string& text, const std::string& file,
                  const std::vector<std::pair<std::string, std::vector<std::string>>>& measures);

// "17,23-30" as numbers, ascending. Throws StudyError; `option` is what it calls the text.
std::vector<uint32_t> parse_numbers(const std::string& text, const std::string& option);

}  // namespace photonloom
