// SPDX-License-Identifier: Apache-2.0
// What `photonloom sweep` left.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <map>
#include <set>
#include <stdexcept>

#include "report/folder.hpp"
#include "report/layers.hpp"

namespace photonloom {
namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

// What a member of summary.json must be for the page.
struct Kind {
  bool (*fits)(const Json&);
  const char* expected;
};
constexpr Kind kText{[](const Json& j) { return j.is_string(); }, "a text"};
constexpr Kind kCount{[](const Json& j) { return j.is_number_unsigned(); },
                      "an integer of at least 0"};
constexpr Kind kFigure{[](const Json& j) { return j.is_number() || j.is_null(); },
                       "a number or null"};
constexpr Kind kArray{[](const Json& j) { return j.is_array(); }, "an array"};
constexpr Kind kObject{[](const Json& j) { return j.is_object(); }, "an object"};
constexpr const char* kStates[] = {"done", "refused", "failed", "missing"};

// Throws std::runtime_error, naming file and member, unless the page can show all of a
// summary.json.
class SummaryCheck {
 public:
  explicit SummaryCheck(const std::string& path) : path_(path) {}

  void check(const Json& summary) const {
    needed(summary, "", "study", kText);
    std::set<std::string> scenes;
    each(summary, "", "scenes", [&](const Json& scene, const std::string& at) {
      scenes.insert(needed(scene, at, "scene", kText).get<std::string>());
      for (const char* name : {"file", "hash", "failure"}) optional(scene, at, name, kText);
      for (const char* name : {"baseline", "reference_relmse"}) optional(scene, at, name, kFigure);
    });
    each(summary, "", "measures", [&](const Json& measure, const std::string& at) {
      for (const char* name : {"measure", "meaning"}) needed(measure, at, name, kText);
      each(measure, at, "columns", [&](const Json& column, const std::string& of) {
        for (const char* name : {"name", "unit", "meaning"}) needed(column, of, name, kText);
      });
    });
    each(summary, "", "fronts", [&](const Json& front, const std::string& at) {
      for (const char* name : {"front", "cost"}) needed(front, at, name, kText);
    });
    each(summary, "", "points", [&](const Json& point, const std::string& at) {
      needed(point, at, "point", kCount);
      for (const char* name : {"plan", "origin"}) needed(point, at, name, kText);
      for (const char* name : {"reason", "command"}) optional(point, at, name, kText);
      optional(point, at, "seeds", kCount);
      const Json& scene = needed(point, at, "scene", kText);
      if (!scenes.count(scene.get<std::string>())) fail(at + ".scene", scene, "one of the scenes");
      const Json& state = needed(point, at, "state", kText);
      if (std::find(std::begin(kStates), std::end(kStates), state.get<std::string>()) ==
          std::end(kStates))
        fail(at + ".state", state, fmt::format("{}", fmt::join(kStates, ", ")));
      for (const auto& [line, value] : needed(point, at, "lines", kObject).items())
        require(at + ".lines." + line, value, kText);
      if (point.contains("front"))
        each(point, at, "front",
             [&](const Json& front, const std::string& of) { require(of, front, kText); });
      for (const auto& [name, mean] : needed(point, at, "values", kObject).items())
        for (const char* figure : {"mean", "error", "ratio", "ratio_error"})
          needed(mean, at + ".values." + name, figure, kFigure);
    });
  }

 private:
  [[noreturn]] void fail(const std::string& name, const Json& value,
                         const std::string& expected) const {
    std::string text = value.dump(-1, ' ', false, Json::error_handler_t::replace);
    if (text.size() > 40) text = text.substr(0, 40) + "...";
    throw std::runtime_error(fmt::format("{}: {} is {}, expected {}", path_, name, text, expected));
  }
  void require(const std::string& name, const Json& value, const Kind& kind) const {
    if (!kind.fits(value)) fail(name, value, kind.expected);
  }
  const Json& needed(const Json& object, const std::string& at, const char* name,
                     const Kind& kind) const {
    const Json& value = member(object, name, at.empty() ? path_ : path_ + ", " + at);
    require(at.empty() ? name : at + "." + name, value, kind);
    return value;
  }
  void optional(const Json& object, const std::string& at, const char* name,
                const Kind& kind) const {
    if (object.contains(name)) needed(object, at, name, kind);
  }
  // Every element of an array, with what messages call it.
  template <class Check>
  void each(const Json& object, const std::string& at, const char* name, const Check& check) const {
    const Json& array = needed(object, at, name, kArray);
    for (size_t i = 0; i < array.size(); ++i)
      check(array[i], fmt::format("{}{}{}[{}]", at, at.empty() ? "" : ".", name, i));
  }

  std::string path_;
};

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
  SummaryCheck(path).check(study);
  for (Json& scene : study.at("scenes")) {
    const auto name = scene.at("scene").get<std::string>();
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
