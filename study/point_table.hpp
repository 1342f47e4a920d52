// SPDX-License-Identifier: Apache-2.0
// points.json: every point of a sweep with the plan that it stands for.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "study/points.hpp"
#include "study/store.hpp"

namespace photonloom {

struct PlannedPoint {
  Point point;
  std::string plan;     // hash; empty: there is none
  std::string command;  // that writes the plan
  std::string refused;  // why no plan has these lines
};

struct SceneEntry {
  std::string name, file;
  std::string hash;              // empty where the scene cannot be used
  std::string failure;           // why
  std::string references;        // signature; empty where none are needed
  double references_relmse = 0;  // their mean's own
};

struct PointTable {
  std::string study;   // its name
  std::string source;  // hash of the study's text and of all that plans follow from
  std::vector<SceneEntry> scenes;
  std::vector<uint64_t> seeds;
  std::vector<std::string> measures;
  std::vector<PlannedPoint> points;  // by number
};

// The file's text, a JSON object whose last member is a checksum of what stands before it, and
// back. Reading throws std::exception for a text that was not written so, and for points that are
// not numbered from 0 or are of no scene.
std::string point_table_text(const PointTable& table);
PointTable parse_point_table(const std::string& text);

}  // namespace photonloom
