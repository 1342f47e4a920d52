// SPDX-License-Identifier: Apache-2.0
// What can be measured of a plan in a scene with a seed, by name. A further study adds a function
// and a line to the list in measures.cpp; store, tables and files follow.
#pragma once
#include <limits>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "golden/pipeline/frame.hpp"
#include "golden/unit/pack_photons.hpp"
#include "study/gather_cost.hpp"
#include "study/study_scene.hpp"

namespace photonloom {

// A figure of a measure.
struct Column {
  const char* name;
  const char* unit;  // "" for a number
  const char* meaning;
};

// A figure that a point has none of.
inline constexpr double kNoValue = std::numeric_limits<double>::quiet_NaN();

// The measure that seeds do not change, and that takes minutes.
inline constexpr const char* kRouted = "routed";

// Sums of blocks of the image that add up to a column's value; kBlocks of them.
using Blocks = std::vector<double>;
inline constexpr int kBlockEdge = 4;  // blocks across and down
inline constexpr int kBlocks = kBlockEdge * kBlockEdge;

// The block that a pixel is in.
size_t block_of(const Planes& image, size_t pixel);

struct Measurement {
  std::vector<double> values;            // a column each; NaN where there is none
  std::map<std::string, Blocks> blocks;  // by column, of those that are sums over the image
};

// One plan in one scene with one seed. What several measures need is made once.
// A film of which each pixel was drawn by lot from a part of the frame, in 64 cells: of each, the
// pixels of one colour of a chessboard minus those of the other, as parts of the mean over all
// pixels. The halves see the same picture, so the sum of squares is the variance of that mean from
// which pixels were drawn and from their noise. Linear, so a mean over seeds and the difference of
// two plans have theirs too.
Blocks half_differences(const std::vector<double>& values, int width, int height);
double root_of_squares(const Blocks& differences);

class PointRun {
 public:
  PointRun(StudyScene& scene, const Study& study, const Plan& plan, uint64_t seed,
           std::string work_dir);

  const Plan& plan() const { return plan_; }
  const Study& study() const { return study_; }
  const StudyScene& scene() const { return scene_; }
  StudyScene& scene() { return scene_; }
  uint64_t seed() const { return seed_; }
  const std::string& work_dir() const { return work_dir_; }

  const Planes& golden();  // the frame in golden arithmetic
  const Planes& walks();   // of it, what the camera's walks alone show: emission and direct
  const ConvergedFrames& converged();  // of golden(), without the noise of final gather rays
  const Planes& reference();  // in reference arithmetic: the same photons, queries and directions
  const FrameCounts& counts();
  const Counters& gather_counters();
  const std::vector<GatherQuery>& watched_queries();
  const PhotonMap& map(bool is_caustic);
  const PackCounts& packed();  // of both maps
  // A frame of this plan, which asks for the same maps, with these units, rendered anew.
  Image render(const Plan& plan, Arithmetic arithmetic, FrameUnits& units, FrameCounts& counts,
               uint64_t ray_seed);

 private:
  void prepare();

  StudyScene& scene_;
  const Study& study_;
  const Plan& plan_;
  uint64_t seed_;
  std::string work_dir_;
  bool prepared_ = false;
  std::shared_ptr<const PhotonPass> passes_[2];
  PhotonMap maps_[2];
  PackCounts packed_;
  std::unique_ptr<Planes> golden_, walks_;
  std::shared_ptr<const ConvergedFrames> reference_;  // its mean; points of one image share it
  std::shared_ptr<const ConvergedFrames> converged_;
  FrameCounts counts_;
  Counters gather_counters_;
  std::vector<GatherQuery> watched_;
};

// The same plan with one pass of cosine-sampled rays and without an irradiance cache: the same for
// all plans that differ in how rays are chosen.
Plan cosine_plan(const Plan& plan);

// The same plan without final gathers: the same for all plans that differ only in these.
Plan direct_plan(const Plan& plan);

struct Measure {
  const char* name;
  const char* meaning;
  std::vector<Column> columns;
  Measurement (*run)(PointRun&);
  // What else the figures depend on than plan, scene and seed; results made with another are made
  // again.
  std::string (*settings)(const Study&, const StudyScene&);
};

const std::vector<Measure>& measures();
const Measure& measure(const std::string& name);
// As parse_study wants them.
std::vector<std::pair<std::string, std::vector<std::string>>> measure_names();

}  // namespace photonloom
