// SPDX-License-Identifier: Apache-2.0
#include "golden/scene/upgrade.hpp"

#include <algorithm>
#include <initializer_list>

namespace photonloom {
namespace {

void set(Element& e, const std::string& attribute, const std::string& value) {
  for (auto& [name, old] : e.attributes)
    if (name == attribute) {
      old = value;
      return;
    }
  e.attributes.emplace_back(attribute, value);
}

bool is_one_of(const std::string& text, std::initializer_list<const char*> words) {
  return std::any_of(words.begin(), words.end(), [&](const char* w) { return text == w; });
}

std::unique_ptr<Element> make(const Element& place, const std::string& tag) {
  auto e = std::make_unique<Element>();
  e->tag = tag;
  e->file = place.file;
  e->line = place.line;
  return e;
}

void rename(Element& parent, const std::string& from, const std::string& to) {
  for (const auto& child : parent.children)
    if ((*child)["name"] == from) set(*child, "name", to);
}

// The field of view was along the shorter side unless told otherwise; the image was mirrored.
void camera(Element& e) {
  e.tag = "sensor";
  if (e["type"] == "perspective") {
    auto axis = make(e, "string");
    set(*axis, "name", "fovAxis");
    set(*axis, "value", "smaller");
    const auto side = std::find_if(e.children.begin(), e.children.end(),
                                   [](const auto& c) { return (*c)["name"] == "mapSmallerSide"; });
    if (side != e.children.end()) {
      if ((**side)["value"] == "false") set(*axis, "value", "larger");
      e.children.erase(side);
    }
    e.children.push_back(std::move(axis));
  }
  for (const auto& child : e.children) {
    if (child->tag != "transform" || (*child)["name"] != "toWorld") continue;
    auto scale = make(*child, "scale");
    set(*scale, "x", "-1");
    child->children.insert(child->children.begin(), std::move(scale));
  }
}

void from_0_3(Element& e) {
  const std::string type = e["type"];
  if (e.tag == "camera") {
    camera(e);
  } else if (e.tag == "luminaire") {
    e.tag = "emitter";
    if (is_one_of(type, {"area", "constant"})) rename(e, "intensity", "radiance");
    if (type == "directional") rename(e, "intensity", "irradiance");
  } else if (e.tag == "film") {
    if (type == "exrfilm") set(e, "type", "hdrfilm");
    if (type == "pngfilm") set(e, "type", "ldrfilm");
    for (const auto& child : e.children)
      if (child->tag == "boolean" && (*child)["name"] == "alpha") {
        child->tag = "string";
        set(*child, "name", "pixelFormat");
      }
  }
  rename(e, "focusDepth", "focusDistance");
  rename(e, "intensityScale", "scale");
}

void visit(Element& e, int64_t minor) {
  if (minor < 4) from_0_3(e);
  if (e.tag == "bsdf" && e["type"] == "bump") set(e, "type", "bumpmap");
  for (const auto& child : e.children) visit(*child, minor);
}

}  // namespace

void upgrade(Element& scene, int64_t minor) {
  if (minor < 5) visit(scene, minor);
}

}  // namespace photonloom
