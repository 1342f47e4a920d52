// SPDX-License-Identifier: Apache-2.0
#include "study/study_scene.hpp"

#include <fmt/core.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <filesystem>

#include "golden/image/image.hpp"
#include "golden/numeric/sha256.hpp"
#include "golden/transport/path.hpp"

namespace photonloom {
namespace {

// Photons of passes that are kept, some 80 bytes each.
constexpr uint64_t kPhotonsKept = 6000000;
constexpr size_t kConvergedKept = 8;  // frames
// Seeds of references, of no study's.
constexpr std::array<uint64_t, 2> kReferenceSeeds{1000001, 1000002};
constexpr uint64_t kWalkSeed = 1000003;
// Samples of the walks' mean and variance, a pixel: kWalkSamples up to kWalkPixels, then as many in
// all as long as each pixel has kWalkSamplesLeast, and at least kWalkFramesLeast frames of them.
constexpr int kWalkSamples = 4096, kWalkPixels = 64 * 64, kWalkSamplesLeast = 256;
constexpr int kWalkFramesLeast = 16;

std::string replaced(std::string text, const std::string& mark, const std::string& by) {
  for (size_t at = 0; (at = text.find(mark, at)) != std::string::npos; at += by.size())
    text.replace(at, mark.size(), by);
  return text;
}

// Whether a pass is traced already, without a failure, and has so many photons.
bool holds(const std::shared_future<std::shared_ptr<const PhotonPass>>& pass, uint64_t photons) {
  if (pass.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return false;
  try {
    return pass.get()->photons.size() == photons;
  } catch (...) {
    return false;
  }
}

// Whether the image was made of this scene; with metadata only.
void check_reference(const Image& image, const std::string& path, const Study& study,
                     const std::string& scene_hash) {
  if (image.width != study.width || image.height != study.height)
    throw std::runtime_error(fmt::format("{}: has {}x{} pixels, expected {}x{} of study.size", path,
                                         image.width, image.height, study.width, study.height));
  const auto hash = image.metadata.find("sceneHash");
  if (hash == image.metadata.end() || hash->second != scene_hash)
    throw std::runtime_error(
        fmt::format("{}: is no reference of this scene (hash {}), expected {}; make references "
                    "makes it again",
                    path, hash == image.metadata.end() ? "missing" : hash->second, scene_hash));
}

// Channels R, G, B: mean; variance.R, .G, .B: of a frame of `spp` samples a pixel.
Image walk_image(const World& world, const RayCaster& caster, int spp, Progress* progress) {
  Image image;
  image.width = world.scene().film.width;
  image.height = world.scene().film.height;
  const int samples =
      std::clamp(static_cast<int>(int64_t{kWalkSamples} * kWalkPixels / image.width / image.height),
                 kWalkSamplesLeast, kWalkSamples);
  const int frames = std::max(samples / spp, kWalkFramesLeast);
  image.metadata["frames"] = fmt::format("{}", frames);
  for (const char* name : {"R", "G", "B", "variance.R", "variance.G", "variance.B"})
    image.add(name);
  const auto width = static_cast<size_t>(image.width);
  const ProgressPhase phase(progress, "camera walks", static_cast<uint64_t>(image.height), "rows");
  tbb::parallel_for(size_t{0}, static_cast<size_t>(image.height), [&](size_t y) {
    for (size_t x = 0; x < width; ++x) {
      // Welford's running mean and sum of squares.
      Rgb mean(0), squares(0);
      for (int f = 0; f < frames; ++f) {
        Rgb value(0);
        for (int s = 0; s < spp; ++s) {
          const CameraSample sample =
              trace_camera(world, caster, static_cast<int>(x), static_cast<int>(y),
                           static_cast<uint64_t>(s), kWalkSeed + static_cast<uint64_t>(f));
          value += sample.emission + sample.direct;
        }
        value /= static_cast<double>(spp);
        const Rgb d = value - mean;
        mean += d / static_cast<double>(f + 1);
        squares += d * (value - mean);
      }
      for (int c = 0; c < 3; ++c) {
        const auto i = static_cast<size_t>(c);
        image.channels[i].pixels[y * width + x] = static_cast<float>(mean[c]);
        image.channels[3 + i].pixels[y * width + x] = static_cast<float>(squares[c] / (frames - 1));
      }
    }
    phase.advance(1);
  });
  return image;
}

// The image in `path` where it was made of this scene and can be read, else what `make` gives,
// which is left there. `say` is told of one that is damaged.
Image find_or_write(const std::string& path, const std::string& scene_hash,
                    const std::string& made_of, const std::function<Image()>& make,
                    const std::function<void(const std::string&)>& say) {
  if (std::filesystem::exists(path)) {
    try {
      // The scene or the study may have changed since.
      Image there = read_exr(path);
      if (there.metadata["madeOf"] == made_of) return there;
    } catch (const std::runtime_error& error) {
      if (say) say(fmt::format("{}; it is made again", error.what()));
    }
  }
  Image image = make();
  image.metadata["sceneHash"] = scene_hash;
  image.metadata["madeOf"] = made_of;
  const std::filesystem::path folder = std::filesystem::path(path).parent_path();
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error)
    throw std::runtime_error(fmt::format("{}: cannot be made a folder ({}), expected one of images",
                                         folder.string(), error.message()));
  write_exr(image, path);
  return read_exr(path);  // as everyone finds it
}

}  // namespace

StudyScene::StudyScene(const std::string& file, const Study& study, const Parameters& parameters)
    : file_(file), name_(std::filesystem::path(file).stem().string()) {
  Scene scene = load_scene(file, parameters);
  // The view of the scene's film, each pixel of its own samples: what is measured are samples.
  scene.film.filter = Filter();
  const bool part = study.frame_width > 0;
  scene.film.resize(part ? study.frame_width : study.width,
                    part ? study.frame_height : study.height);
  scene.film.width = study.width;
  scene.film.height = study.height;
  scene.film.frame_width = study.frame_width;
  scene.film.frame_height = study.frame_height;
  world_ = std::make_unique<World>(std::move(scene));
  caster_ = make_double_bvh(*world_);
}

std::string StudyScene::hash_text() const { return fmt::format("{:016x}", world_->scene().hash); }

namespace {

// What is in `all`, the longest unused first, at the first key that is `same`; else the value of
// `key`, made by the first who asks while others wait for it. `trim` then drops what is too much.
template <class Key, class Value, class Same, class Trim, class Make>
std::shared_ptr<const Value> find_or_make(
    std::mutex& mutex,
    std::deque<std::pair<Key, std::shared_future<std::shared_ptr<const Value>>>>& all,
    const Key& key, const Same& same, const Trim& trim, const Make& make) {
  std::promise<std::shared_ptr<const Value>> promise;
  {
    std::unique_lock lock(mutex);
    for (auto it = all.begin(); it != all.end(); ++it) {
      if (!same(it->first, it->second)) continue;
      const auto found = it->second;
      std::rotate(it, it + 1, all.end());
      lock.unlock();
      return found.get();
    }
    all.emplace_back(key, promise.get_future().share());
    trim(all);
  }
  try {
    auto value = std::make_shared<const Value>(make());
    promise.set_value(value);
    return value;
  } catch (...) {
    promise.set_exception(std::current_exception());
    throw;
  }
}

}  // namespace

std::shared_ptr<const PhotonPass> StudyScene::photons(bool is_caustic, uint64_t stored,
                                                      uint64_t seed) {
  const PhotonKey key{is_caustic, stored, seed};
  const auto same = [&](const PhotonKey& kept, const PhotonFuture& future) {
    const auto& [of_caustic, asked, of_seed] = kept;
    // The path that fills a map is stored whole: who asks for all that a pass has means that pass.
    return kept == key ||
           (of_caustic == is_caustic && of_seed == seed && asked < stored && holds(future, stored));
  };
  const auto trim = [](auto& all) {
    uint64_t photons = 0;
    for (const auto& [kept, future] : all) photons += std::get<1>(kept);
    while (photons > kPhotonsKept && all.size() > 1) {
      photons -= std::get<1>(all.front().first);
      all.pop_front();
    }
  };
  return find_or_make(mutex_, kept_, key, same, trim, [&] {
    return is_caustic ? trace_caustic_photons(*world_, *caster_, stored, seed)
                      : trace_global_photons(*world_, *caster_, stored, seed);
  });
}

std::shared_ptr<const ConvergedFrames> StudyScene::converged(
    const std::string& key, const std::function<ConvergedFrames()>& make) {
  const auto same = [&](const std::string& kept, const ConvergedFuture&) { return kept == key; };
  const auto trim = [](auto& all) {
    if (all.size() > kConvergedKept) all.pop_front();
  };
  return find_or_make(mutex_, converged_, key, same, trim, make);
}

StudyScene::Any StudyScene::shared_any(const std::string& key, const std::function<Any()>& make) {
  std::promise<Any> promise;
  {
    std::unique_lock lock(mutex_);
    const auto [at, is_new] = shared_.try_emplace(key, promise.get_future().share());
    if (!is_new) {
      const std::shared_future<Any> found = at->second;
      lock.unlock();
      return found.get();
    }
  }
  try {
    Any made = make();
    promise.set_value(made);
    return made;
  } catch (...) {
    promise.set_exception(std::current_exception());
    throw;
  }
}

void StudyScene::load_references(const Study& study, const std::string& folder, Progress* progress,
                                 std::function<void(const std::string&)> say) {
  references_folder_ = folder;
  say_ = std::move(say);
  size_text_ = fmt::format("{}x{}", study.width, study.height);
  if (study.frame_width > 0)
    size_text_ += fmt::format(".of{}x{}", study.frame_width, study.frame_height);
  Planes* const planes[2] = {&references_.b1, &references_.b2};
  std::string paths[2];
  for (size_t n = 0; n < 2; ++n) {
    std::string& path = paths[n];
    // The scene's name may hold either mark.
    if (!study.reference_files.empty())
      path = replaced(replaced(study.reference_files, "{n}", fmt::format("{}", n + 1)), "{scene}",
                      name_);
    Image image;
    if (path.empty() || (study.reference_spp > 0 && !std::filesystem::exists(path))) {
      path = fmt::format("{}/{}.{}.{}.exr", folder, name_, size_text_, n + 1);
      const std::string made_of = fmt::format("{} {}", hash_text(), study.reference_spp);
      const auto make = [&] {
        const std::unique_ptr<RayCaster> embree = make_embree(*world_);
        Image traced = render_path(
            *world_, *embree,
            {.spp = study.reference_spp, .seed = kReferenceSeeds[n], .progress = progress});
        std::erase_if(traced.channels, [](const Channel& c) { return c.name.size() > 1; });
        return traced;
      };
      image = find_or_write(path, hash_text(), made_of, make, say_);
    } else {
      image = read_exr(path);
    }
    check_reference(image, path, study, hash_text());
    *planes[n] = planes_of(image, "", path);
  }
  const Planes &b1 = references_.b1, &b2 = references_.b2;
  references_.mean = b1;
  Sha256 sum;
  double own = 0;
  for (size_t c = 0; c < 3; ++c)
    for (size_t p = 0; p < b1.c[c].size(); ++p) {
      const double b = (b1.c[c][p] + b2.c[c][p]) / 2, d = b1.c[c][p] - b2.c[c][p];
      references_.mean.c[c][p] = b;
      own += d * d / 4 / (b * b + 0.01);
      sum.add(fmt::format("{},{};", b1.c[c][p], b2.c[c][p]));
    }
  references_.own_relmse = own / (3.0 * static_cast<double>(b1.c[0].size()));
  references_.signature = sum.hex().substr(0, 16);
  if (b1.c == b2.c)
    throw std::runtime_error(
        fmt::format("{}: is the same image as {}, expected two references of different seeds",
                    paths[1], paths[0]));
}

const SceneReferences& StudyScene::references() const {
  if (references_.signature.empty())
    throw std::logic_error(fmt::format("{}: no references were loaded", name_));
  return references_;
}

std::shared_ptr<const WalkNoise> StudyScene::walk_noise(int spp, Progress* progress) {
  return shared<WalkNoise>(fmt::format("walks of {}", spp), [&] {
    const std::string path =
        fmt::format("{}/{}.{}.walks{}.exr", references_folder_, name_, size_text_, spp);
    const Image image = find_or_write(
        path, hash_text(), fmt::format("{} walks of {}", hash_text(), spp),
        [&] { return walk_image(*world_, *caster_, spp, progress); }, say_);
    WalkNoise noise{planes_of(image, "", path), planes_of(image, "variance", path),
                    std::stod(image.metadata.at("frames"))};
    require_same_size(noise.mean, references().mean);
    return noise;
  });
}

}  // namespace photonloom
