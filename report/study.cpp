// SPDX-License-Identifier: Apache-2.0
// What `photonloom sweep` left.
#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <stdexcept>

#include "report/folder.hpp"
#include "report/layers.hpp"

namespace photonloom {
namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

// The mean of the path-traced references that the sweep made of this scene; nothing where it made
// none.
void add_references(const std::string& folder, const std::string& name,
                    const std::string& scene_hash, ImageSet& images) {
  std::map<std::string, Image> of_scene;  // by file
  if (fs::is_directory(folder) && !scene_hash.empty())
    for (const auto& e : fs::directory_iterator(folder)) {
      // NAME.SIZE.SEED.exr; others there are no means of a frame (docs/sweep.md).
      const std::string seed = e.path().stem().extension().string();
      if (!e.path().filename().string().starts_with(name + ".") || e.path().extension() != ".exr" ||
          seed.size() < 2 ||
          !std::all_of(seed.begin() + 1, seed.end(), [](char c) { return c >= '0' && c <= '9'; }))
        continue;
      Image image = read_exr(e.path().string());
      if (image.metadata["sceneHash"] == scene_hash)
        of_scene.emplace(e.path().string(), std::move(image));
    }
  if (of_scene.empty()) return;
  const std::string first = of_scene.begin()->first;
  Image sum = of_scene.begin()->second;
  for (const auto& [file, more] : of_scene) {
    if (file == first) continue;
    if (more.width != sum.width || more.height != sum.height)
      throw std::runtime_error(fmt::format("{}: has {}x{} pixels, expected {}x{} as {} has", file,
                                           more.width, more.height, sum.width, sum.height, first));
    for (Channel& c : sum.channels) {
      const Channel* other = more.find(c.name);
      if (!other) throw std::runtime_error(fmt::format("{}: has no channel {}", file, c.name));
      for (size_t p = 0; p < c.pixels.size(); ++p) c.pixels[p] += other->pixels[p];
    }
  }
  for (Channel& c : sum.channels)
    for (float& v : c.pixels) v /= static_cast<float>(of_scene.size());
  images.add("reference", first,
             fmt::format("path traced, mean of {} images with seeds of their own", of_scene.size()),
             std::move(sum));
}

// The image alone: what a study shows is not for inspection of layers.
Image without_layers(Image image) {
  std::erase_if(image.channels,
                [](const Channel& c) { return c.name != "R" && c.name != "G" && c.name != "B"; });
  return image;
}

// Plans of the points as {"meanings": [[section, key, meaning]], "plans": {hash: [[value,
// reason]]}}, line by line in the order of the meanings.
Json plans_of(const std::string& folder, const Json& points) {
  Json meanings = Json::array(), plans = Json::object();
  for (const Json& point : points) {
    const std::string hash = point.value("plan", std::string());
    const std::string file = folder + "/plans/" + hash + ".toml";
    if (hash.empty() || plans.contains(hash) || !fs::exists(file)) continue;
    const Json plan = read_plan_lines(file);
    if (plan.at("hash") != hash)
      throw std::runtime_error(fmt::format("{}: has the hash {}, expected that of its name", file,
                                           plan.at("hash").get<std::string>()));
    Json lines = Json::array();
    for (const Json& line : plan.at("lines")) {
      if (plans.empty())
        meanings.push_back({line.at("section"), line.at("key"), line.at("meaning")});
      lines.push_back({line.at("value"), line.at("reason")});
    }
    plans[hash] = lines;
  }
  return {{"meanings", meanings}, {"plans", plans}};
}

}  // namespace

bool is_study(const std::string& folder) {
  return fs::exists(folder + "/points.json") || fs::exists(folder + "/results.csv");
}

Json study_json(const std::string& folder, const std::vector<ExtraImage>& extra,
                Payloads& payloads) {
  const std::string path = folder + "/summary.json";
  Json study = read_object(path);
  for (const char* name : {"study", "scenes", "measures", "fronts", "points"})
    member(study, name, path);
  for (const Json& point : study.at("points"))
    for (const char* name : {"point", "scene", "plan", "origin", "state", "lines", "values"})
      member(point, name, fmt::format("{}, points", path));
  for (Json& scene : study.at("scenes")) {
    const std::string name = member(scene, "scene", path).get<std::string>();
    ImageSet images(kStudyMantissa, payloads);
    for (const ExtraImage& e : extra)
      if (e.scene == name)
        images.add(e.label, e.file, "given with --image", without_layers(read_exr(e.file)));
    add_references(folder + "/references", name, scene.value("hash", std::string()), images);
    scene["images"] = images.empty() ? Json() : images.json();
  }
  study["folder"] = folder;
  const Json plans = plans_of(folder, study.at("points"));
  study["plans_kept"] = plans.at("plans").size();
  study["plans"] = payloads.add(plans.dump());
  return study;
}

}  // namespace photonloom
