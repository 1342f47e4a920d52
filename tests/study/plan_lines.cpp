// SPDX-License-Identifier: Apache-2.0
// No line of the plan is dead: each, set to another value, changes error, cost or image as
// plan_lines.toml states. That file has an entry for each line of Plan::visit, and none beside.
#include <fmt/core.h>

#include <toml++/toml.h>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <map>
#include <memory>
#include <set>
#include <sstream>

#include "golden/packet/layout.hpp"
#include "golden/packet/packet.hpp"
#include "golden/plan/plan_file.hpp"
#include "golden/planner/resources.hpp"
#include "study/measures.hpp"
#include "study/point_plan.hpp"
#include "tests/catch.hpp"
#include "tests/scene_files.hpp"

using namespace photonloom;

namespace {

std::string environment(const char* name) {
  const char* value = std::getenv(name);
  REQUIRE(value);
  return value;
}

const char* const kRoom =
    "<scene version=\"0.6.0\">"
    "<integrator type=\"path\"/>"
    "<sensor type=\"perspective\"><transform name=\"toWorld\">"
    "<lookat origin=\"0,0,0.9\" target=\"0,0,-1\" up=\"0,1,0\"/></transform></sensor>"
    "<shape type=\"cube\"><boolean name=\"flipNormals\" value=\"true\"/>"
    "<bsdf type=\"diffuse\"><rgb name=\"reflectance\" value=\"0.7,0.7,0.7\"/></bsdf></shape>"
    "<shape type=\"disk\"><transform name=\"toWorld\"><scale value=\"0.3\"/>"
    "<rotate x=\"1\" angle=\"90\"/><translate y=\"0.98\"/></transform>"
    "<emitter type=\"area\"><rgb name=\"radiance\" value=\"10,10,10\"/></emitter></shape>"
    "</scene>";

Study small_study(const std::string& scene) {
  Study study;
  study.scenes = {scene};
  study.seeds = {1};
  study.width = study.height = 12;
  study.gather_queries = 256;
  study.base = {{"photons", "4096"},
                {"caustic_photons", "2048"},
                {"gather.k", "16"},
                {"frame.spp", "4"},
                {"frame.gather_rays", "8"},
                {"reorder.packets", "512"},
                {"gatherer.cache_bytes", "8192"}};
  return study;
}

// Whatever of a plan can be looked at, each worked out when it is asked for.
class Figures {
 public:
  Figures(StudyScene& scene, const Study& study, const Plan& plan)
      : plan_(plan), run_(scene, study, plan_, 1, "cosim"), rtl_study_(study) {
    rtl_study_.rtl_cycles = true;
    rtl_run_ = std::make_unique<PointRun>(scene, rtl_study_, plan_, 1, "cosim");
  }

  const Plan& plan() const { return plan_; }
  const Planes& image() { return run_.golden(); }

  double of(const std::string& name) {
    if (name == "mean") {
      double sum = 0;
      for (const auto& channel : image().c)
        for (const double v : channel) sum += v;
      return sum;
    }
    if (name == "clamped") return static_cast<double>(run_.counts().clamped);
    if (name == "query.bits") return PacketLayout::of<GatherQuery>(plan_).bits();
    if (name == "pixel.bits") return plan_.pixel_sum_bits();
    if (name == "board.ebr") return board_memories(plan_).total();
    if (name == "board.units") return board_memories(plan_).units;
    if (name == "rtl.cycles") return measure("gather").run(*rtl_run_).values[0];
    const size_t dot = name.find('.');
    const Measure& m = measure(name.substr(0, dot));
    auto& values = measured_[m.name];
    if (values.empty()) values = m.run(run_).values;
    for (size_t i = 0; i < m.columns.size(); ++i)
      if (name.substr(dot + 1) == m.columns[i].name) return values[i];
    throw std::logic_error("there is no figure " + name);
  }

 private:
  Plan plan_;
  PointRun run_;
  Study rtl_study_;
  std::unique_ptr<PointRun> rtl_run_;
  std::map<std::string, std::vector<double>> measured_;
};

struct Entry {
  std::string line, to, scene;
  LineValues with, also;
  std::vector<std::pair<std::string, std::string>> shows;  // figure, direction
  bool needs_rtl() const {
    return std::any_of(shows.begin(), shows.end(), [](auto& s) { return s.first == "rtl.cycles"; });
  }
};

// As a plan file has it.
std::string text_of(const toml::node& node) {
  std::ostringstream out;
  if (const auto* array = node.as_array()) {
    for (const toml::node& n : *array) out << (out.str().empty() ? "[" : ", ") << text_of(n);
    return out.str() + "]";
  }
  if (const auto* s = node.as_string()) return s->get();
  if (const auto* b = node.as_boolean()) return b->get() ? "true" : "false";
  if (const auto* i = node.as_integer()) return fmt::format("{}", i->get());
  const double x = node.as_floating_point()->get();
  return fmt::format("{}{}", x, std::floor(x) == x ? ".0" : "");
}

std::vector<Entry> entries() {
  std::vector<Entry> all;
  const std::string file = environment("PHOTONLOOM_SOURCE") + "/tests/study/plan_lines.toml";
  for (const auto& [line, node] : toml::parse_file(file)) {
    const toml::table& t = *node.as_table();
    Entry e;
    e.line = std::string(line.str());
    INFO(e.line);
    REQUIRE(t.contains("to"));
    REQUIRE(t["shows"].is_string());
    e.to = text_of(*t.get("to"));
    e.scene = t["scene"].value_or(std::string());
    for (const auto& [key, lines] : {std::make_pair("with", &e.with), {"also", &e.also}})
      if (const toml::table* values = t[key].as_table())
        for (const auto& [name, value] : *values)
          lines->emplace_back(std::string(name.str()), text_of(value));
    std::istringstream shows(t["shows"].value_or(std::string()));
    for (std::string one; std::getline(shows, one, ',');) {
      std::istringstream words(one);
      std::string figure, direction;
      words >> figure >> direction;
      e.shows.emplace_back(figure, direction);
    }
    REQUIRE(!e.shows.empty());
    all.push_back(e);
  }
  return all;
}

// The value of a line in the plan's file.
std::string value_in(const Plan& plan, const std::string& line) {
  std::istringstream text(plan_text(plan));
  std::string section, row;
  while (std::getline(text, row)) {
    if (row.rfind("[", 0) == 0) section = row.substr(1, row.find(']') - 1);
    const size_t equals = row.find(" = ");
    if (equals != std::string::npos && section + "." + row.substr(0, equals) == line)
      return row.substr(equals + 3, row.find_first_of(" \n", equals + 3) - equals - 3);
  }
  throw std::logic_error("no line " + line);
}

// "x0.25" and "+6" relative to the plan's.
std::string value_for(const Entry& e, const Plan& plan) {
  if (e.to[0] != 'x' && e.to[0] != '+') return e.to;
  const std::string old = value_in(plan, e.line);
  const double by = std::stod(e.to.substr(1)), from = std::stod(old);
  const double value = e.to[0] == 'x' ? from * by : from + by;
  return old.find('.') != std::string::npos ? fmt::format("{:.9f}", value)
                                            : fmt::format("{:.0f}", value);
}

class Scenes {
 public:
  StudyScene& of(const std::string& name) {
    auto& scene = scenes_[name];
    if (!scene) {
      const std::string file = name == "room"
                                   ? folder_.write("room.xml", kRoom)
                                   : environment("PHOTONLOOM_SOURCE") + "/scenes/" +
                                         (name.empty() ? "cornell_balls" : name) + ".xml";
      scene = std::make_unique<StudyScene>(file, small_study(file));
    }
    return *scene;
  }

 private:
  TestFolder folder_;
  std::map<std::string, std::unique_ptr<StudyScene>> scenes_;
};

void check_entry(const Entry& e, Scenes& scenes) {
  StudyScene& scene = scenes.of(e.scene);
  const Study study = small_study(scene.file());
  Figures before(scene, study, plan_of_point(scene, study, e.with).plan);
  LineValues lines = e.with;
  lines.emplace_back(e.line, value_for(e, before.plan()));
  INFO(e.line << " from " << value_in(before.plan(), e.line) << " to " << lines.back().second);
  lines.insert(lines.end(), e.also.begin(), e.also.end());
  Plan changed = before.plan();
  // Another colour than the photons' is refused in a point.
  if (e.line == "photon.channel_color")
    set_plan_line(changed, e.line + "=" + lines.back().second);
  else
    changed = plan_of_point(scene, study, lines).plan;
  Figures after(scene, study, changed);
  for (const auto& [figure, direction] : e.shows) {
    bool same;
    double a = 0, b = 0;
    if (figure == "image") {
      same = before.image().c == after.image().c;
    } else if (figure == "hash") {
      same = plan_hash_text(before.plan()) == plan_hash_text(after.plan());
    } else {
      a = before.of(figure);
      b = after.of(figure);
      same = a == b;
    }
    INFO(figure << ": " << a << ", then " << b << "; expected " << direction);
    if (direction == "same")
      CHECK(same);
    else if (direction == "changes")
      CHECK(!same);
    else if (direction == "up")
      CHECK(b > a);
    else if (direction == "down")
      CHECK(b < a);
    else
      FAIL("unknown direction");
  }
}

}  // namespace

TEST_CASE("every line of the plan has an entry that says what it does") {
  std::set<std::string> lines, known;
  const Plan plan;
  Plan::visit(plan, [&](const char* section, const char* key, const auto&, auto, auto,
                        const char*) { lines.insert(fmt::format("{}.{}", section, key)); });
  for (const Entry& e : entries()) known.insert(e.line);
  for (const std::string& line : lines) {
    INFO(line << " has no entry in tests/study/plan_lines.toml, expected one that says what the "
                 "line does");
    CHECK(known.count(line) == 1);
  }
  for (const std::string& line : known) {
    INFO(line << " of tests/study/plan_lines.toml is no line of the plan");
    CHECK(lines.count(line) == 1);
  }
}

TEST_CASE("every line of the plan does what its entry says") {
  Scenes scenes;
  for (const Entry& e : entries())
    if (!e.needs_rtl()) check_entry(e, scenes);
}

TEST_CASE("lines that only the RTL's cycles show", "[slow]") {
  Scenes scenes;
  int checked = 0;
  for (const Entry& e : entries())
    if (e.needs_rtl()) {
      check_entry(e, scenes);
      ++checked;
    }
  CHECK(checked > 0);
}
