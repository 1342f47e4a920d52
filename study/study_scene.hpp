// SPDX-License-Identifier: Apache-2.0
// What the points of one scene share: world, ray caster, photons by seed, references.
#pragma once
#include <cstdint>
#include <deque>
#include <functional>
#include <future>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <tuple>

#include "golden/image/metrics.hpp"
#include "golden/numeric/progress.hpp"
#include "golden/transport/world.hpp"
#include "study/study_file.hpp"

namespace photonloom {

// Two path-traced images of the scene with seeds of their own, and their mean.
struct SceneReferences {
  Planes b1, b2, mean;
  double own_relmse = 0;  // of the mean: mean (b1 - b2)^2 / (4 (b^2 + 0.01))
  std::string signature;  // 16 hexadecimal digits of all pixels
};

// What the camera's walks alone show: emitters seen and direct light. Their noise is the same in
// every plan of as many samples a pixel, and known here from many frames of them. A frame's samples
// are spread evenly in a pixel, so its variance is not that of one sample by their number.
struct WalkNoise {
  Planes mean;        // over all frames
  Planes variance;    // of one frame
  double frames = 0;  // of different seeds
};

// Two images of the same photons, camera walks and plan with so many final gather rays that they
// are nearly without noise, and rays of their own.
struct ConvergedFrames {
  Planes b1, b2, mean;
};

// May be asked by several threads at once.
class StudyScene {
 public:
  // Throws SceneError and whatever reading the file throws.
  StudyScene(const std::string& file, const Study& study, const Parameters& parameters = {});

  const std::string& file() const { return file_; }
  const std::string& name() const { return name_; }  // the file's, without folder and extension
  std::string hash_text() const;                     // 16 hexadecimal digits
  const World& world() const { return *world_; }
  const RayCaster& caster() const { return *caster_; }

  // As trace_global_photons and trace_caustic_photons; the last few are kept.
  std::shared_ptr<const PhotonPass> photons(bool is_caustic, uint64_t stored, uint64_t seed);

  // What `make` gives for this key; the last few are kept.
  std::shared_ptr<const ConvergedFrames> converged(const std::string& key,
                                                   const std::function<ConvergedFrames()>& make);

  // What points share beside photons: made once for each key, which names the type too, and kept.
  template <class T>
  std::shared_ptr<const T> shared(const std::string& key, const std::function<T()>& make) {
    return std::static_pointer_cast<const T>(
        shared_any(key, [&make] { return std::make_shared<const T>(make()); }));
  }

  // From the study's files, else from `folder`, else path traced into it. Call it once, before
  // references() is asked, which throws std::logic_error without. An image of `folder` that is
  // damaged is made again, now or later, and `say` is told so, by any thread.
  void load_references(const Study& study, const std::string& folder, Progress* progress,
                       std::function<void(const std::string&)> say = {});
  const SceneReferences& references() const;

  // Of frames of `spp` samples a pixel; beside the references, made when first asked for. The
  // references must be loaded.
  std::shared_ptr<const WalkNoise> walk_noise(int spp, Progress* progress = nullptr);

 private:
  using Any = std::shared_ptr<const void>;
  Any shared_any(const std::string& key, const std::function<Any()>& make);

  using PhotonKey = std::tuple<bool, uint64_t, uint64_t>;
  using PhotonFuture = std::shared_future<std::shared_ptr<const PhotonPass>>;
  using ConvergedFuture = std::shared_future<std::shared_ptr<const ConvergedFrames>>;

  std::string file_, name_;
  std::unique_ptr<World> world_;
  std::unique_ptr<RayCaster> caster_;
  std::mutex mutex_;
  std::deque<std::pair<PhotonKey, PhotonFuture>> kept_;            // the longest unused first
  std::deque<std::pair<std::string, ConvergedFuture>> converged_;  // likewise
  std::map<std::string, std::shared_future<Any>> shared_;
  SceneReferences references_;
  std::string references_folder_, size_text_;  // the latter names files: 64x64
  std::function<void(const std::string&)> say_;
};

}  // namespace photonloom
