// SPDX-License-Identifier: Apache-2.0
#include "report/folder.hpp"

#include <fmt/core.h>

#include <sstream>
#include <stdexcept>

#include "golden/image/metrics.hpp"
#include "golden/numeric/output_file.hpp"
#include "golden/plan/plan_file.hpp"
#include "report/layers.hpp"

namespace photonloom {

using Json = nlohmann::ordered_json;

Json read_object(const std::string& path) {
  const std::string text = read_file(path);
  Json json = Json::parse(text, nullptr, false);
  if (json.is_discarded() || !json.is_object())
    throw std::runtime_error(fmt::format("{}: is damaged, expected one JSON object", path));
  return json;
}

const Json& member(const Json& object, const std::string& name, const std::string& path) {
  if (!object.is_object() || !object.contains(name))
    throw std::runtime_error(fmt::format("{}: has no \"{}\"", path, name));
  return object.at(name);
}

void ImageSet::add(const std::string& label, const std::string& file, const std::string& about,
                   Image image) {
  Entry entry{label, file, about, std::move(image), {}};
  if (like_.empty()) {
    like_ = file;
    width_ = entry.image.width;
    height_ = entry.image.height;
  }
  if (entry.image.width != width_ || entry.image.height != height_)
    throw std::runtime_error(fmt::format("{}: has {}x{} pixels, expected {}x{} as {} has", file,
                                         entry.image.width, entry.image.height, width_, height_,
                                         like_));
  for (const Entry& e : images_) {
    if (e.label == label)
      throw std::runtime_error(fmt::format("{}: there is an image '{}' already", file, label));
    const auto same = [](const Channel& a, const Channel& b) {
      return a.name == b.name && a.pixels == b.pixels;
    };
    if (e.same_as.empty() && entry.same_as.empty() &&
        std::equal(e.image.channels.begin(), e.image.channels.end(), entry.image.channels.begin(),
                   entry.image.channels.end(), same))
      entry.same_as = e.label;
  }
  images_.push_back(std::move(entry));
}

void ImageSet::expect_size_of(const std::string& file) {
  const Image image = read_exr(file);
  like_ = file;
  width_ = image.width;
  height_ = image.height;
}

void ImageSet::add_file(const std::string& label, const std::string& file,
                        const std::string& about) {
  add(label, file, about, read_exr(file));
}

Json ImageSet::json() {
  Json list = Json::array(), pairs = Json::array();
  const auto golden = std::find_if(images_.begin(), images_.end(),
                                   [](const Entry& e) { return e.label == "golden"; });
  // An entry with layers of its own, from which the others' differences are.
  size_t base = golden == images_.end() ? 0 : static_cast<size_t>(golden - images_.begin());
  for (size_t i = 0; i < base; ++i)
    if (images_[i].label == images_[base].same_as) base = i;
  for (size_t i = 0; i < images_.size(); ++i) {
    const Entry& e = images_[i];
    Json entry = {{"label", e.label}, {"file", e.file}, {"about", e.about}, {"same_as", e.same_as}};
    if (e.same_as.empty())
      entry["layers"] =
          packed_layers(e.image, mantissa_, payloads_, i == base ? nullptr : &images_[base].image);
    list.push_back(entry);
    for (size_t j = 0; j < i && e.same_as.empty(); ++j) {
      if (!images_[j].same_as.empty()) continue;
      std::vector<double> flip;
      const Metrics m = compare_planes(planes_of(e.image, "", e.file),
                                       planes_of(images_[j].image, "", images_[j].file), &flip);
      pairs.push_back({{"a", e.label},
                       {"b", images_[j].label},
                       {"relmse", m.relmse},
                       {"rmse", m.rmse},
                       {"mape", m.mape},
                       {"mean_ratio", m.mean_ratio},
                       {"flip", m.flip},
                       {"flip_map", packed_map(flip, e.image.width, payloads_)}});
    }
  }
  return {{"width", images_.empty() ? 0 : images_[0].image.width},
          {"height", images_.empty() ? 0 : images_[0].image.height},
          {"mantissa", mantissa_},
          {"base", images_.empty() ? "" : images_[base].label},
          {"list", list},
          {"pairs", pairs}};
}

Json read_plan_lines(const std::string& path) {
  const Plan plan = read_plan(path);
  std::map<std::string, std::string> texts;  // by section.key, behind "key = "
  std::istringstream in(read_file(path));
  std::string section;
  for (std::string line; std::getline(in, line);) {
    if (!line.empty() && line[0] == '[') section = line.substr(1, line.find(']') - 1);
    const size_t equals = line.find('=');
    if (equals == std::string::npos || line[0] == '#') continue;
    const std::string key = line.substr(0, line.find_first_of(" \t="));
    texts[section + "." + key] = line.substr(line.find_first_not_of(" \t", equals + 1));
  }
  Json lines = Json::array();
  Plan::visit(plan, [&](const std::string& s, const std::string& key, const auto&, auto, auto,
                        const std::string& meaning) {
    const std::string text = texts[s + "." + key];
    const std::string comment = " # " + meaning;
    size_t end = text.find(comment);
    std::string reason;
    if (end != std::string::npos && text.compare(end + comment.size(), 2, ": ") == 0)
      reason = text.substr(end + comment.size() + 2);
    if (end == std::string::npos) end = text.find('#');
    std::string value = text.substr(0, end);
    value.resize(value.find_last_not_of(" \t\r") + 1);
    lines.push_back(
        {{"section", s}, {"key", key}, {"value", value}, {"meaning", meaning}, {"reason", reason}});
  });
  return {{"hash", plan_hash_text(plan)}, {"lines", lines}};
}

}  // namespace photonloom
