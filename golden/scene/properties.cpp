// SPDX-License-Identifier: Apache-2.0
#include "golden/scene/properties.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "golden/numeric/elementary.hpp"
#include "golden/numeric/text.hpp"

namespace photonloom {
namespace {

constexpr const char* kPropertyTags[] = {
    "integer", "float",    "boolean",   "string",    "point",     "vector", "rgb",
    "srgb",    "spectrum", "transform", "animation", "blackbody", "rgba",   "color"};

bool is_property(const std::string& tag) {
  return std::find(std::begin(kPropertyTags), std::end(kPropertyTags), tag) !=
         std::end(kPropertyTags);
}

void check_attributes(const Element& element, std::initializer_list<const char*> names) {
  for (const auto& [name, value] : element.attributes)
    if (std::find_if(names.begin(), names.end(),
                     [name = name](const char* n) { return n == name; }) == names.end())
      fail(element, fmt::format("attribute '{}' of <{}> is not supported", name, element.tag));
}

double finite(const Element& element, std::string_view text, const std::string& attribute) {
  const auto value = parse_double(text);
  if (!value || !std::isfinite(*value))
    fail(element, fmt::format("'{}' in {} of {} is not a finite number",
                              std::string(text.substr(0, 40)), attribute, describe(element)));
  return *value;
}

// Words of a vector: separated by commas, blanks or both.
std::vector<double> numbers(const Element& element, const std::string& attribute) {
  std::vector<double> out;
  for (const std::string_view word : split(element[attribute], ", \t\r\n"))
    out.push_back(finite(element, word, attribute));
  return out;
}

Vec3 triple(const Element& element, const std::string& attribute) {
  const std::vector<double> v = numbers(element, attribute);
  if (v.size() != 3)
    fail(element, fmt::format("{} of {} has {} numbers, expected 3", attribute, describe(element),
                              v.size()));
  return {v[0], v[1], v[2]};
}

// x, y, z attributes (missing: `otherwise`), or one attribute `value` with three numbers, or, where
// `scalar` allows it, one.
Vec3 xyz(const Element& element, double otherwise, bool scalar, bool may_be_empty) {
  const bool has_value = element.find("value") != nullptr;
  const bool has_xyz = element.find("x") || element.find("y") || element.find("z");
  if (has_value && has_xyz)
    fail(element, fmt::format("{} has both value and x, y, z", describe(element)));
  if (has_value) {
    const std::vector<double> v = numbers(element, "value");
    if (v.size() == 3) return {v[0], v[1], v[2]};
    if (v.size() == 1 && scalar) return Vec3(v[0]);
    fail(element, fmt::format("value of {} has {} numbers, expected {}", describe(element),
                              v.size(), scalar ? "1 or 3" : "3"));
  }
  if (!has_xyz && !may_be_empty)
    fail(element, fmt::format("{} has neither value nor x, y, z", describe(element)));
  Vec3 v(otherwise);
  const char* const names[] = {"x", "y", "z"};
  for (int i = 0; i < 3; ++i)
    if (const std::string* text = element.find(names[i])) v[i] = finite(element, *text, names[i]);
  return v;
}

Mat4 columns(const Vec3& x, const Vec3& y, const Vec3& z, const Vec3& origin) {
  return Mat4(glm::dvec4(x, 0), glm::dvec4(y, 0), glm::dvec4(z, 0), glm::dvec4(origin, 1));
}

Mat4 rotation(const Element& element) {
  Vec3 axis = xyz(element, 0, false, true);
  if (!element.find("angle")) fail(element, "<rotate> has no angle");
  const double angle = finite(element, element["angle"], "angle");
  const double largest = max_component(glm::abs(axis));
  if (largest == 0) fail(element, "<rotate> has a zero axis");
  axis /= largest;  // so that the length neither underflows nor overflows
  axis /= glm::length(axis);
  const Vec2 cs = cos_sin_turns(angle / 360);
  const double c = cs.x, s = cs.y;
  // Rodrigues' formula, column by column.
  const auto column = [&](const Vec3& e) {
    return e * c + glm::cross(axis, e) * s + axis * (glm::dot(axis, e) * (1 - c));
  };
  return columns(column({1, 0, 0}), column({0, 1, 0}), column({0, 0, 1}), Vec3(0));
}

// Scales what has a square that is no number, or next to none.
void bring_near_one(Vec3& v) {
  const double largest = max_component(glm::abs(v));
  if (largest > 0 && !(largest > 1e-100 && largest < 1e100)) v /= largest;
}

Mat4 look_at(const Element& element, bool new_dialect) {
  for (const char* name : {"origin", "target"})
    if (!element.find(name)) fail(element, fmt::format("<{}> has no {}", element.tag, name));
  const Vec3 origin = triple(element, "origin"), target = triple(element, "target");
  Vec3 up(0);
  if (element.find("up") && !element["up"].empty()) up = triple(element, "up");
  Vec3 direction = target - origin;
  if (direction == Vec3(0))
    fail(element, fmt::format("<{}> looks from a point to itself", element.tag));
  bring_near_one(direction);
  bring_near_one(up);
  const double length = glm::length(direction);
  if (!std::isfinite(length))
    fail(element, fmt::format("<{}>: origin and target are farther apart than a number can say",
                              element.tag));
  direction /= length;
  if (up == Vec3(0)) {
    // Any axis will do, but the image depends on it: the same as Mitsuba's.
    if (new_dialect) {
      up = Frame(direction).s;
    } else {
      const Vec3 d = direction;
      Vec3 c;
      if (std::fabs(d.x) > std::fabs(d.y)) {
        const double inverse = 1 / std::sqrt(d.x * d.x + d.z * d.z);
        c = Vec3(d.z * inverse, 0, -d.x * inverse);
      } else {
        const double inverse = 1 / std::sqrt(d.y * d.y + d.z * d.z);
        c = Vec3(0, d.z * inverse, -d.y * inverse);
      }
      up = glm::cross(c, d);
    }
  }
  Vec3 left = glm::cross(up, direction);
  const double sine = glm::length(left);
  // Parallel up to the rounding of the cross product itself.
  if (!(sine > 1e-14 * glm::length(up)))
    fail(element, fmt::format("up of <{}> is parallel to the viewing direction", element.tag));
  left /= sine;
  return columns(left, glm::cross(direction, left), direction, origin);
}

Mat4 matrix(const Element& element) {
  const std::vector<double> v = numbers(element, "value");
  if (v.size() != 16 && v.size() != 9)
    fail(element, fmt::format("<matrix> has {} numbers, expected 16 (or 9) row by row", v.size()));
  Mat4 m(1);
  const size_t n = v.size() == 16 ? 4 : 3;
  for (size_t row = 0; row < n; ++row)
    for (size_t column = 0; column < n; ++column)
      m[static_cast<int>(column)][static_cast<int>(row)] = v[row * n + column];
  if (m[0][3] != 0 || m[1][3] != 0 || m[2][3] != 0 || m[3][3] != 1)
    fail(element, "the last row of <matrix> is not 0 0 0 1: perspective maps are not supported");
  return m;
}

Rgb from_srgb(const Rgb& c) {
  Rgb out;
  for (int i = 0; i < 3; ++i) out[i] = srgb_to_linear(c[i]);
  return out;
}

}  // namespace

std::string canonical_name(const std::string& name) {
  std::string out;
  for (size_t i = 0; i < name.size(); ++i) {
    const char c = name[i];
    const bool capital = c >= 'A' && c <= 'Z';
    if (capital && i > 0 && name[i - 1] >= 'a' && name[i - 1] <= 'z') out += '_';
    out += capital ? static_cast<char>(c - 'A' + 'a') : c;
  }
  return out;
}

Properties::Properties(const Document& document, const Element& object)
    : document_(document), object_(object), type_(lower(object["type"])) {
  if (object.tag != "scene") check_attributes(object, {"type", "id", "name"});
  if (object.tag != "scene" && type_.empty())
    fail(object, fmt::format("{} has no type", describe(object)));
  for (const auto& child : object.children) {
    if (!is_property(child->tag)) {
      if (child->tag == "null") continue;
      if (child->tag == "ref") check_attributes(*child, {"id", "name"});
      children_.push_back({&document.resolve(*child), child.get()});
      continue;
    }
    const std::string name = canonical_name((*child)["name"]);
    if (name.empty()) fail(*child, fmt::format("<{}> has no name", child->tag));
    if (const Property* first = find(name))
      fail(*child, fmt::format("{} is given twice, first in line {}", describe(*child),
                               first->element->line));
    properties_.push_back({name, child.get(), false});
  }
}

const Properties::Property* Properties::find(const std::string& name) const {
  for (const Property& p : properties_)
    if (p.name == name) return &p;
  return nullptr;
}

const Element& Properties::element(const std::string& name) const {
  const Property* p = find(name);
  return p ? *p->element : object_;
}

bool Properties::is_text(const std::string& name) const {
  const Property* p = find(name);
  return p && p->element->tag == "string";
}

const Element* Properties::take(const std::string& name, std::initializer_list<const char*> tags) {
  asked_.push_back(name);
  for (Property& p : properties_) {
    if (p.name != name) continue;
    p.used = true;
    std::string expected;
    for (const char* tag : tags) {
      if (p.element->tag == tag) return p.element;
      expected += fmt::format("{}<{}>", expected.empty() ? "" : " or ", tag);
    }
    fail(*p.element, fmt::format("{} in {} is not supported, expected {}", describe(*p.element),
                                 describe(object_), expected));
  }
  return nullptr;
}

double Properties::number(const std::string& name, double otherwise) {
  const Element* e = take(name, {"float", "integer"});
  if (!e) return otherwise;
  check_attributes(*e, {"name", "value"});
  return finite(*e, (*e)["value"], "value");
}

int64_t Properties::integer(const std::string& name, int64_t otherwise) {
  const Element* e = take(name, {"integer"});
  if (!e) return otherwise;
  check_attributes(*e, {"name", "value"});
  const auto value = parse_integer((*e)["value"]);
  if (!value)
    fail(*e, fmt::format("'{}' in value of {} is not an integer", (*e)["value"], describe(*e)));
  return *value;
}

bool Properties::boolean(const std::string& name, bool otherwise) {
  const Element* e = take(name, {"boolean"});
  if (!e) return otherwise;
  check_attributes(*e, {"name", "value"});
  const std::string value = lower((*e)["value"]);
  if (value != "true" && value != "false")
    fail(*e,
         fmt::format("'{}' in value of {} is neither true nor false", (*e)["value"], describe(*e)));
  return value == "true";
}

std::string Properties::text(const std::string& name, const std::string& otherwise) {
  const Element* e = take(name, {"string"});
  if (!e) return otherwise;
  check_attributes(*e, {"name", "value"});
  return (*e)["value"];
}

Vec3 Properties::vector(const std::string& name, const Vec3& otherwise) {
  const Element* e = take(name, {"point", "vector"});
  if (!e) return otherwise;
  check_attributes(*e, {"name", "value", "x", "y", "z"});
  return xyz(*e, 0, false, false);
}

namespace {

double kelvins(const Element& e, std::optional<double> kelvin, const std::string& text) {
  constexpr double kHottest = 1e9;
  if (!kelvin || !(*kelvin > 0 && *kelvin <= kHottest))
    fail(e, fmt::format("temperature of {} is '{}', expected kelvins like 5000K, at most {:g}",
                        describe(e), text, kHottest));
  return *kelvin;
}

// temperature="5000K", scale="1".
Rgb blackbody(const Element& e) {
  check_attributes(e, {"name", "temperature", "scale"});
  std::string text = e["temperature"];
  if (text.ends_with('K') || text.ends_with('k')) text.pop_back();
  const double kelvin = kelvins(e, parse_double(text), e["temperature"]);
  const double scale = e.find("scale") ? finite(e, e["scale"], "scale") : 1;
  if (scale < 0) fail(e, fmt::format("scale of {} is negative, expected at least 0", describe(e)));
  return blackbody_color(kelvin, scale);
}

}  // namespace

// The spectrum plugins of 3.x: <spectrum type="blackbody"> and the like.
Rgb Properties::spectrum_plugin(const Element& e, SpectrumOf of) const {
  Properties p(document_, e);
  const std::string place = fmt::format("{}:{}", *e.file, e.line);
  Rgb c(0);
  if (p.type() == "blackbody") {
    const double kelvin = p.number("temperature", 5000);
    c = blackbody_color(kelvins(e, kelvin, fmt::format("{}", kelvin)), 1);
  } else if (p.type() == "uniform") {
    c = Rgb(p.number("value", 1));
  } else if (p.type() == "d65") {
    c = Rgb(p.number("scale", 1));  // white
  } else if (p.type() == "rgb" || p.type() == "srgb") {
    c = p.color("color", Rgb(0.5));
  } else if (p.type() == "regular" || p.type() == "irregular") {
    const std::string texts[] = {p.text("wavelengths", ""), p.text("values", "")};
    const auto values = split(texts[1], ", \t\r\n");
    std::vector<std::string> points;
    if (p.type() == "irregular") {
      for (const auto word : split(texts[0], ", \t\r\n")) points.emplace_back(word);
    } else {
      const double first = p.number("wavelength_min", 360), last = p.number("wavelength_max", 830);
      const double steps = std::max<double>(1, static_cast<double>(values.size()) - 1);
      for (size_t i = 0; i < values.size(); ++i)
        points.push_back(
            fmt::format("{}", first + (last - first) * static_cast<double>(i) / steps));
    }
    if (points.size() != values.size() || values.empty())
      fail(e, fmt::format("{} has {} wavelengths and {} values, expected as many of one as of the "
                          "other, at least one",
                          describe(e), points.size(), values.size()));
    std::string list;
    for (size_t i = 0; i < points.size(); ++i) list += fmt::format("{}:{} ", points[i], values[i]);
    c = spectrum_color(parse_spectrum(list, place), of);
  } else {
    fail(e,
         fmt::format("{} is unknown, expected type blackbody, uniform, d65, rgb, srgb, regular or "
                     "irregular",
                     describe(e)));
  }
  for (int i = 0; i < 3; ++i)
    if (c[i] < 0) fail(e, fmt::format("{} is negative, expected at least 0", describe(e)));
  for (const Property& property : p.properties_)
    if (!property.used)
      fail(*property.element,
           fmt::format("{} has no place in {}", describe(*property.element), describe(e)));
  return c;
}

Rgb Properties::color(const std::string& name, const Rgb& otherwise, SpectrumOf of) {
  const Element* e = take(name, {"rgb", "spectrum", "srgb", "float", "blackbody"});
  if (!e) return otherwise;
  if (e->tag == "blackbody") return blackbody(*e);
  if (e->tag == "spectrum" && e->find("type")) return spectrum_plugin(*e, of);
  if (e->tag == "spectrum" &&
      (e->find("filename") || (*e)["value"].find(':') != std::string::npos)) {
    check_attributes(*e, {"name", "value", "filename", "intent"});
    if (e->find("filename") && e->find("value"))
      fail(*e, fmt::format("{} has both filename and value, expected one", describe(*e)));
    return spectrum_color(
        e->find("filename")
            ? read_spd(document_.find_file(*e, (*e)["filename"]))
            : parse_spectrum((*e)["value"], fmt::format("{}:{}", *e->file, e->line)),
        of);
  }
  check_attributes(*e, {"name", "value", "intent"});
  const auto words = split((*e)["value"], ", \t\r\n");
  Rgb c;
  if (words.size() == 1 && words[0][0] == '#' && (e->tag == "rgb" || e->tag == "srgb")) {
    const std::string_view digits = words[0].substr(1);
    int value[3] = {0, 0, 0};
    if (digits.size() != 6 ||
        digits.find_first_not_of("0123456789abcdefABCDEF") != std::string_view::npos)
      fail(*e, fmt::format("'{}' in value of {} is not a color, expected #rrggbb",
                           std::string(words[0].substr(0, 40)), describe(*e)));
    for (size_t i = 0; i < 6; ++i) {
      const char d = lower(std::string(1, digits[i]))[0];
      value[i / 2] = value[i / 2] * 16 + (d <= '9' ? d - '0' : d - 'a' + 10);
    }
    for (int i = 0; i < 3; ++i) c[i] = value[i] / 255.0;
  } else {
    const std::vector<double> v = numbers(*e, "value");
    if (v.size() == 1) {
      c = Rgb(v[0]);
    } else if (v.size() == 3 && e->tag != "float") {
      c = Rgb(v[0], v[1], v[2]);
    } else {
      fail(*e, fmt::format("value of {} has {} numbers, expected {}", describe(*e), v.size(),
                           e->tag == "float" ? "1" : "1 or 3"));
    }
  }
  for (int i = 0; i < 3; ++i)
    if (c[i] < 0)
      fail(*e, fmt::format("value of {} is negative, expected at least 0", describe(*e)));
  return e->tag == "srgb" ? from_srgb(c) : c;
}

Mat4 Properties::transform(const std::string& name) {
  const Element* e = take(name, {"transform"});
  if (!e) return Mat4(1);
  check_attributes(*e, {"name"});
  Mat4 m(1);
  for (const auto& step : e->children) {
    const std::string& tag = step->tag;
    for (const auto& child : step->children)
      fail(*child, fmt::format("<{}> is not allowed in <{}>", child->tag, tag));
    Mat4 next(1);
    if (tag == "translate") {
      check_attributes(*step, {"x", "y", "z", "value"});
      next = columns({1, 0, 0}, {0, 1, 0}, {0, 0, 1}, xyz(*step, 0, false, true));
    } else if (tag == "scale") {
      check_attributes(*step, {"x", "y", "z", "value"});
      const Vec3 s = xyz(*step, 1, true, false);
      next = columns({s.x, 0, 0}, {0, s.y, 0}, {0, 0, s.z}, Vec3(0));
    } else if (tag == "rotate") {
      check_attributes(*step, {"x", "y", "z", "value", "angle"});
      next = rotation(*step);
    } else if (tag == "lookat" || tag == "lookAt" || tag == "look_at") {
      check_attributes(*step, {"origin", "target", "up"});
      next = look_at(*step, document_.new_dialect);
    } else if (tag == "matrix") {
      check_attributes(*step, {"value"});
      next = matrix(*step);
    } else {
      fail(*step, fmt::format("<{}> is not supported in <transform>, expected translate, scale, "
                              "rotate, lookat or matrix",
                              tag));
    }
    m = next * m;
  }
  // Relative to the columns' lengths: a tiny scale is not singular.
  const glm::dmat3 linear(m);
  const double volume = std::fabs(glm::determinant(linear));
  const double box = glm::length(linear[0]) * glm::length(linear[1]) * glm::length(linear[2]);
  bool good = std::isfinite(box) && box > 0 && volume > 1e-12 * box;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) good = good && std::isfinite(m[i][j]);
  if (!good) fail(*e, fmt::format("{} is singular", describe(*e)));
  return m;
}

void Properties::ignore(std::initializer_list<const char*> names) {
  for (const char* name : names)
    for (Property& p : properties_)
      if (p.name == name) p.used = true;
}

void Properties::ignore_labels() {
  for (Property& p : properties_)
    if (p.name.starts_with("label[") || p.name.starts_with("metadata[")) p.used = true;
}

void Properties::ignore_all() {
  for (Property& p : properties_) p.used = true;
}

const Properties::Child* Properties::object_of(const std::string& name) {
  asked_.push_back(name);
  for (const Child& c : children_) {
    const std::string& given = (*c.place)["name"];
    if (given.empty() || canonical_name(given) != name) continue;
    if (find(name)) fail(*c.place, fmt::format("{} is given twice", describe(*c.place)));
    if (std::find(taken_.begin(), taken_.end(), c.place) != taken_.end()) continue;
    taken_.push_back(c.place);
    return &c;
  }
  asked_.pop_back();  // whoever asks for the value itself names it
  return nullptr;
}

std::vector<Properties::Child> Properties::rest() const {
  std::vector<Child> out;
  for (const Child& c : children_)
    if (std::find(taken_.begin(), taken_.end(), c.place) == taken_.end()) out.push_back(c);
  return out;
}

void Properties::finish(Findings& findings) const {
  for (const Property& p : properties_) {
    if (p.used) continue;
    std::string known;
    for (const std::string& name : asked_) known += (known.empty() ? "" : ", ") + name;
    findings.add(*p.element,
                 fmt::format("{} is not supported in {}, expected one of: {}", describe(*p.element),
                             describe(object_), known.empty() ? "nothing" : known),
                 "it is left out");
  }
}

void Properties::no_rest(Findings& findings) const {
  for (const Child& c : rest())
    findings.add(*c.place,
                 fmt::format("{} is not supported in {}", describe(*c.object), describe(object_)),
                 "it is left out");
}

}  // namespace photonloom
