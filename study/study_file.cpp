// SPDX-License-Identifier: Apache-2.0
#include "study/study_file.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <set>
#include <sstream>
#include <tuple>
#include <type_traits>

#include "golden/numeric/strict_size.hpp"
#include "golden/plan/plan_file.hpp"

namespace photonloom {
namespace {

using Measures = std::vector<std::pair<std::string, std::vector<std::string>>>;

template <class Names>
std::string listed(const Names& names) {
  std::string list;
  for (const auto& name : names) list += (list.empty() ? "" : ", ") + std::string(name);
  return list;
}

std::string scene_name(const std::string& file) {
  return std::filesystem::path(file).stem().string();
}

// Each scene's baseline, and the points of the sets.
uint64_t point_count(const Study& study) {
  uint64_t points = study.scenes.size();
  for (const PointSet& set : study.sets)
    points += set.points() * (set.scenes.empty() ? study.scenes.size() : set.scenes.size());
  return points;
}

// An empty text where a '+' has no name before or after it.
std::vector<std::string> split(const std::string& names) {
  std::vector<std::string> parts{""};
  for (const char c : names)
    if (c == '+')
      parts.emplace_back();
    else
      parts.back() += c;
  return parts;
}

// Whether one of the lines takes integers alone.
bool is_whole(const std::string& names) {
  const std::vector<std::string> lines = split(names);
  const auto has = [&](const std::string& line) {
    return std::find(lines.begin(), lines.end(), line) != lines.end();
  };
  bool whole = has("photons") || has("caustic_photons");
  const Plan plan;
  Plan::visit(
      plan, [&](const char* section, const char* key, const auto& value, auto, auto, const char*) {
        using Value = std::decay_t<decltype(value)>;
        whole |= std::is_integral_v<Value> && !std::is_same_v<Value, bool> &&
                 has(fmt::format("{}.{}", section, key));
      });
  return whole;
}

// Whether the text is a number or a truth value, which TOML writes without quotes.
bool is_bare(const std::string& text) {
  double x = 0;
  const auto r = std::from_chars(text.data(), text.data() + text.size(), x);
  return text == "true" || text == "false" ||
         (r.ec == std::errc() && r.ptr == text.data() + text.size());
}

// By any of which a table is a range of values; no line of a plan is called so.
constexpr const char* kRangeKeys[] = {"from", "to", "log"};

class Parser {
 public:
  Parser(const std::string& file, const Measures& measures) : file_(file), measures_(measures) {}

  Study parse(const std::string& text) {
    toml::table root;
    try {
      root = parse_toml(text, file_);
    } catch (const toml::parse_error& error) {
      throw StudyError(fmt::format("{}:{}: {}", file_, error.source().begin.line,
                                   std::string(error.description())));
    }
    expect_keys(root, "", {"study", "references", "gather", "formats", "bounds", "base", "points"});
    study_.file = file_;
    study_.text = text;
    study_section(section(root, "study", true));
    if (const toml::table* t = section(root, "references", false)) references(*t);
    if (const toml::table* t = section(root, "gather", false)) gather(*t);
    for (const char* measure : {"formats", "bounds"})
      if (const toml::table* t = section(root, measure, false)) {
        expect_keys(*t, measure, {"seeds"});
        study_.first_seeds[measure] =
            seed_count(needed(*t, measure, "seeds", "a number"), fmt::format("{}.seeds", measure));
      }
    if (const toml::table* t = section(root, "base", false)) study_.base = line_values(*t);
    if (const toml::node* points = root.get("points")) {
      const toml::array* sets = points->as_array();
      if (!sets) fail(*points, "points is no array of tables, expected [[points]]");
      for (const toml::node& set : *sets) {
        if (!set.is_table()) fail(set, "points holds a value, expected [[points]] tables");
        study_.sets.push_back(point_set(*set.as_table()));
        if (point_count(study_) > kMostPoints)
          fail(set, fmt::format("with these the study has too many points, expected at most {} in "
                                "all scenes",
                                kMostPoints));
      }
    }
    if (const std::string name = study_.referenced();
        !name.empty() && study_.reference_spp == 0 && study_.reference_files.empty())
      throw StudyError(
          fmt::format("{}: measure {} needs [references], with spp or files", file_, name));
    return std::move(study_);
  }

 private:
  [[noreturn]] void fail(const toml::node& at, const std::string& what) const {
    throw StudyError(fmt::format("{}:{}: {}", file_, at.source().begin.line, what));
  }

  void expect_keys(const toml::table& table, const std::string& name,
                   const std::vector<std::string>& keys) const {
    for (const auto& [key, node] : table)
      if (std::find(keys.begin(), keys.end(), std::string(key.str())) == keys.end())
        throw StudyError(fmt::format("{}:{}: unknown {} {}{}, expected one of {}", file_,
                                     key.source().begin.line, name.empty() ? "section" : "key",
                                     name.empty() ? "" : name + ".", std::string(key.str()),
                                     listed(keys)));
  }

  const toml::table* section(const toml::table& root, const char* name, bool needed) const {
    const toml::node* node = root.get(name);
    if (node && !node->is_table()) fail(*node, fmt::format("{} is no section [{}]", name, name));
    if (!node && needed) throw StudyError(fmt::format("{}: section [{}] is missing", file_, name));
    return node ? node->as_table() : nullptr;
  }

  const toml::node& needed(const toml::table& table, const std::string& name, const char* key,
                           const char* expected) const {
    const toml::node* node = table.get(key);
    if (!node) fail(table, fmt::format("{}.{} is missing, expected {}", name, key, expected));
    return *node;
  }

  int64_t integer(const toml::node& node, const std::string& name, int64_t low,
                  int64_t high) const {
    const auto* value = node.as_integer();
    if (!value || value->get() < low || value->get() > high)
      fail(node, fmt::format("{} is {}, expected an integer from {} to {}", name, toml_text(node),
                             low, high));
    return value->get();
  }

  // So many first seeds of the study.
  int seed_count(const toml::node& node, const std::string& name) const {
    return static_cast<int>(integer(node, name, 1, static_cast<int64_t>(study_.seeds.size())));
  }

  std::string text(const toml::node& node, const std::string& name) const {
    const auto* value = node.as_string();
    if (!value || value->get().empty())
      fail(node, fmt::format("{} is {}, expected a text", name, toml_text(node)));
    return value->get();
  }

  const toml::array& array(const toml::node& node, const std::string& name,
                           const char* expected) const {
    const toml::array* values = node.as_array();
    if (!values || values->empty())
      fail(node, fmt::format("{} is {}, expected {}", name, toml_text(node), expected));
    return *values;
  }

  // A path that the study names stands beside the study file.
  std::string beside(const std::string& path) const {
    const std::filesystem::path p(path);
    return p.is_absolute()
               ? path
               : (std::filesystem::path(file_).parent_path() / p).lexically_normal().string();
  }

  void study_section(const toml::table* t) {
    expect_keys(*t, "study", {"name", "scenes", "seeds", "size", "measure"});
    study_.name = text(needed(*t, "study", "name", "a text"), "study.name");
    std::set<std::string> stems;
    const char* scenes = "an array of scene files";
    for (const toml::node& n :
         array(needed(*t, "study", "scenes", scenes), "study.scenes", scenes)) {
      study_.scenes.push_back(beside(text(n, "study.scenes")));
      if (const std::string name = scene_name(study_.scenes.back()); !stems.insert(name).second)
        fail(n, fmt::format("study.scenes has two scenes of the name {}", name));
    }
    const char* seeds = "an array of different integers of at least 0";
    for (const toml::node& n : array(needed(*t, "study", "seeds", seeds), "study.seeds", seeds)) {
      study_.seeds.push_back(static_cast<uint64_t>(integer(n, "study.seeds", 0, INT64_MAX)));
      if (std::count(study_.seeds.begin(), study_.seeds.end(), study_.seeds.back()) > 1)
        fail(n, fmt::format("study.seeds has {} twice", study_.seeds.back()));
    }
    const toml::node& size = needed(*t, "study", "size", "\"WIDTHxHEIGHT\"");
    const std::string pixels = text(size, "study.size");
    const auto edges = strict_size(pixels, 4096);
    if (!edges)
      fail(size, fmt::format("study.size is {}, expected \"WIDTHxHEIGHT\" of 1 to 4096 pixels each",
                             toml_text(size)));
    std::tie(study_.width, study_.height) = *edges;
    std::vector<std::string> names;
    for (const auto& [name, columns] : measures_) names.push_back(name);
    const std::string measures = "an array of " + listed(names);
    for (const toml::node& n : array(needed(*t, "study", "measure", measures.c_str()),
                                     "study.measure", measures.c_str())) {
      const std::string name = text(n, "study.measure");
      if (std::find(names.begin(), names.end(), name) == names.end())
        fail(n, fmt::format("study.measure has {}, expected one of {}", name, listed(names)));
      if (std::count(study_.measures.begin(), study_.measures.end(), name))
        fail(n, fmt::format("study.measure has {} twice", name));
      study_.measures.push_back(name);
    }
  }

  void references(const toml::table& t) {
    expect_keys(t, "references", {"spp", "files"});
    if (const toml::node* n = t.get("spp"))
      study_.reference_spp = static_cast<int>(integer(*n, "references.spp", 1, 1 << 24));
    if (const toml::node* n = t.get("files")) {
      study_.reference_files = beside(text(*n, "references.files"));
      for (const char* mark : {"{scene}", "{n}"})
        if (study_.reference_files.find(mark) == std::string::npos)
          fail(*n, fmt::format("references.files is {}, expected a path with {{scene}} and {{n}}",
                               toml_text(*n)));
    }
  }

  void gather(const toml::table& t) {
    expect_keys(t, "gather", {"cycles", "queries", "latency", "seeds"});
    if (const toml::node* n = t.get("cycles")) {
      const std::string source = text(*n, "gather.cycles");
      if (source != "rtl" && source != "model")
        fail(*n, fmt::format("gather.cycles is {}, expected rtl or model", source));
      study_.rtl_cycles = source == "rtl";
    }
    if (const toml::node* n = t.get("queries"))
      study_.gather_queries = static_cast<int>(integer(*n, "gather.queries", 1, 1 << 20));
    if (const toml::node* n = t.get("latency"))
      study_.latency = static_cast<int>(integer(*n, "gather.latency", 1, 10000));
    if (const toml::node* n = t.get("seeds"))
      study_.first_seeds["gather"] = seed_count(*n, "gather.seeds");
  }

  // A value that a line cannot take is refused where it stands; what goes with what is the plan's.
  void check_value(const toml::node& at, const std::string& names) const {
    const std::string value = value_text(at);
    if (at.is_string() && is_bare(value))
      fail(at, fmt::format("{0} is \"{1}\" in quotes, expected {1} without", names, value));
    const std::string problem = line_problem(names, value, "study.size");
    if (!problem.empty()) fail(at, problem);
  }

  // The lines of a table in the order of the file; of one that is set twice, under whatever names,
  // only one value could count.
  template <class Take>
  void each_line(const toml::table& table, Take&& take) const {
    std::set<std::string> seen;
    each_entry(table, "", [&](const std::string& names, const toml::node& node) {
      take(names, node);
      for (const std::string& line : split(names))
        if (!seen.insert(line).second)
          fail(node, fmt::format("{} is set twice, expected once", line));
    });
  }

  // Sections as TOML nests them.
  template <class Take>
  void each_entry(const toml::table& table, const std::string& prefix, Take&& take) const {
    std::vector<std::pair<const toml::key*, const toml::node*>> entries;
    for (const auto& [key, node] : table) entries.emplace_back(&key, &node);
    std::sort(entries.begin(), entries.end(), [](const auto& a, const auto& b) {
      const auto place = [](const toml::key& k) {
        return std::make_pair(k.source().begin.line, k.source().begin.column);
      };
      return place(*a.first) < place(*b.first);
    });
    for (const auto& [key, node] : entries) {
      const std::string name = prefix + std::string(key->str());
      const toml::table* inner = node->as_table();
      const bool is_range = inner && std::any_of(std::begin(kRangeKeys), std::end(kRangeKeys),
                                                 [&](auto k) { return inner->contains(k); });
      if (inner && !is_range)
        each_entry(*inner, name + ".", take);
      else
        take(name, *node);
    }
  }

  LineValues line_values(const toml::table& table) const {
    LineValues values;
    each_line(table, [&](const std::string& name, const toml::node& node) {
      if (node.is_array() || node.is_table())
        fail(node, fmt::format("{} has several values, expected one", name));
      check_value(node, name);
      values.emplace_back(name, value_text(node));
    });
    return values;
  }

  LineChoice choice(const std::string& name, const toml::node& node) const {
    LineChoice c;
    c.line = name;
    if (const toml::array* values = node.as_array()) {
      if (values->empty()) fail(node, fmt::format("{} is [], expected values", name));
      for (const toml::node& v : *values) {
        check_value(v, name);
        c.values.push_back(value_text(v));
      }
      return c;
    }
    const toml::table* range = node.as_table();
    if (!range) {
      check_value(node, name);
      c.values.push_back(value_text(node));
      return c;
    }
    expect_keys(*range, name, {std::begin(kRangeKeys), std::end(kRangeKeys)});
    const auto bound = [&](const char* key) {
      const toml::node& n = needed(*range, name, key, "a number");
      if (!n.is_number())
        fail(n, fmt::format("{}.{} is {}, expected a number", name, key, toml_text(n)));
      check_value(n, name);
      return n.is_integer() ? static_cast<double>(n.as_integer()->get())
                            : n.as_floating_point()->get();
    };
    c.whole = is_whole(name);
    c.from = bound("from");
    c.to = bound("to");
    if (!(c.from <= c.to))
      fail(node,
           fmt::format("{} goes from {} to {}, expected the smaller first", name, c.from, c.to));
    if (const toml::node* log = range->get("log")) {
      if (!log->is_boolean())
        fail(*log, fmt::format("{}.log is {}, expected true or false", name, toml_text(*log)));
      c.logarithmic = log->as_boolean()->get();
      if (c.logarithmic && !(c.from > 0))
        fail(*log,
             fmt::format("{} begins at {}, expected more than 0 where log is true", name, c.from));
    }
    return c;
  }

  // Of the scenes that points.scenes names, by their files' names without folder and extension.
  std::vector<size_t> scene_numbers(const toml::node& node) const {
    std::vector<std::string> names;
    for (const std::string& file : study_.scenes) names.push_back(scene_name(file));
    const std::string expected = "an array of " + listed(names);
    std::set<size_t> numbers;
    for (const toml::node& n : array(node, "points.scenes", expected.c_str())) {
      const auto at = std::find(names.begin(), names.end(), text(n, "points.scenes"));
      if (at == names.end())
        fail(n,
             fmt::format("points.scenes has {}, expected one of {}", value_text(n), listed(names)));
      if (!numbers.insert(static_cast<size_t>(at - names.begin())).second)
        fail(n, fmt::format("points.scenes has {} twice", value_text(n)));
    }
    return {numbers.begin(), numbers.end()};
  }

  PointSet point_set(const toml::table& t) const {
    PointSet set;
    set.line = static_cast<int>(t.source().begin.line);
    const toml::node& strategy =
        needed(t, "points", "strategy", "list, grid, latin_hypercube or search");
    const std::string name = text(strategy, "points.strategy");
    if (const toml::node* n = t.get("seeds")) set.seeds = seed_count(*n, "points.seeds");
    if (const toml::node* n = t.get("scenes")) set.scenes = scene_numbers(*n);
    if (name == "list") {
      expect_keys(t, "points", {"strategy", "seeds", "scenes", "lines"});
      const char* expected = "an array of { line = value } tables";
      for (const toml::node& n :
           array(needed(t, "points", "lines", expected), "points.lines", expected)) {
        if (!n.is_table())
          fail(n, fmt::format("points.lines has {}, expected {{ line = value }}", value_text(n)));
        set.list.push_back(line_values(*n.as_table()));
      }
      return set;
    }
    if (name == "grid") {
      set.strategy = Strategy::kGrid;
      expect_keys(t, "points", {"strategy", "seeds", "scenes", "lines"});
    } else if (name == "latin_hypercube") {
      set.strategy = Strategy::kLatinHypercube;
      expect_keys(t, "points", {"strategy", "seeds", "scenes", "count", "seed", "lines"});
      set.count = static_cast<int>(
          integer(needed(t, "points", "count", "a number of points"), "points.count", 1, 1000000));
    } else if (name == "search") {
      set.strategy = Strategy::kSearch;
      expect_keys(t, "points",
                  {"strategy", "seeds", "scenes", "population", "generations", "seed", "objectives",
                   "lines"});
      set.population = static_cast<int>(integer(
          needed(t, "points", "population", "points a generation"), "points.population", 2, 10000));
      set.generations =
          static_cast<int>(integer(needed(t, "points", "generations", "a number of generations"),
                                   "points.generations", 1, 10000));
      const char* expected = "an array of measure.column";
      for (const toml::node& n :
           array(needed(t, "points", "objectives", expected), "points.objectives", expected))
        set.objectives.push_back(objective(n));
    } else {
      fail(strategy, fmt::format("points.strategy is {}, expected list, grid, latin_hypercube or "
                                 "search",
                                 name));
    }
    if (const toml::node* seed = t.get("seed"))
      set.seed = static_cast<uint64_t>(integer(*seed, "points.seed", 0, INT64_MAX));
    const toml::node& lines = needed(t, "points", "lines", "a table of lines");
    if (!lines.is_table() || lines.as_table()->empty())
      fail(lines, "points.lines is no table, expected lines with values");
    each_line(*lines.as_table(), [&](const std::string& line, const toml::node& node) {
      set.choices.push_back(choice(line, node));
      if (set.strategy == Strategy::kGrid && set.choices.back().values.empty())
        fail(node, fmt::format("{} is a range, expected an array of values in a grid", line));
    });
    return set;
  }

  std::string objective(const toml::node& node) const {
    const std::string name = text(node, "points.objectives");
    std::string known;
    for (const auto& [measure, columns] : measures_) {
      const bool is_asked = std::find(study_.measures.begin(), study_.measures.end(), measure) !=
                            study_.measures.end();
      for (const std::string& column : columns) {
        if (!is_asked) continue;
        if (name == measure + "." + column) return name;
        known += (known.empty() ? "" : ", ") + measure + "." + column;
      }
    }
    fail(node, fmt::format("points.objectives has {}, expected one of {}", name, known));
  }

  std::string file_;
  const Measures& measures_;
  Study study_;
};

}  // namespace

std::string value_text(const toml::node& node) {
  if (const auto* i = node.as_integer()) return fmt::format("{}", i->get());
  if (const auto* s = node.as_string()) return s->get();
  return toml_text(node);
}

bool PointSet::has_scene(size_t scene) const {
  return scenes.empty() || std::binary_search(scenes.begin(), scenes.end(), scene);
}

uint64_t PointSet::points() const {
  if (strategy == Strategy::kList) return list.size();
  if (strategy == Strategy::kLatinHypercube) return static_cast<uint64_t>(count);
  if (strategy == Strategy::kSearch)
    return static_cast<uint64_t>(population) * static_cast<uint64_t>(generations);
  uint64_t points = 1;
  for (const LineChoice& c : choices)
    if (points <= kMostPoints) points *= c.values.size();
  return points;
}

std::vector<std::string> replace_scenes(Study& study, const std::vector<std::string>& files) {
  std::vector<std::string> names;
  for (const std::string& file : files) {
    names.push_back(scene_name(file));
    if (std::count(names.begin(), names.end(), names.back()) > 1)
      throw StudyError(
          fmt::format("SCENE {}: a scene of the name {} is there already, expected scenes of "
                      "different names",
                      file, names.back()));
  }
  std::vector<std::string> left_out;
  std::erase_if(study.sets, [&](PointSet& set) {
    if (set.scenes.empty()) return false;
    std::vector<size_t> kept;
    std::string asked;
    for (const size_t scene : set.scenes) {
      asked += (asked.empty() ? "" : ", ") + scene_name(study.scenes[scene]);
      const auto at = std::find(names.begin(), names.end(), scene_name(study.scenes[scene]));
      if (at != names.end()) kept.push_back(static_cast<size_t>(at - names.begin()));
    }
    std::sort(kept.begin(), kept.end());
    set.scenes = kept;
    if (kept.empty())
      left_out.push_back(
          fmt::format("{}:{}: these [[points]] are left out, none of their scenes ({}) "
                      "is asked for",
                      study.file, set.line, asked));
    return kept.empty();
  });
  study.scenes = files;
  if (point_count(study) > kMostPoints)
    throw StudyError(
        fmt::format("{}: has too many points with {} scenes, expected at most {} in all of them",
                    study.file, files.size(), kMostPoints));
  return left_out;
}

std::string Study::referenced() const {
  for (const std::string& name : measures)
    if (name == "visible" || name == "lot") return name;
  return "";
}

std::string line_problem(const std::string& names, const std::string& value,
                         const std::string& size) {
  for (const std::string& line : split(names)) {
    const auto whole = [&](int64_t low, int64_t high) -> std::string {
      int64_t x = 0;
      const auto r = std::from_chars(value.data(), value.data() + value.size(), x);
      if (r.ec == std::errc() && r.ptr == value.data() + value.size() && x >= low && x <= high)
        return "";
      return fmt::format("{} is {}, expected an integer from {} to {}", line, value, low, high);
    };
    std::string problem;
    if (line.empty()) {
      problem = fmt::format("'{}' has a + without a line beside it", names);
    } else if (line == "photons" || line == "caustic_photons") {
      problem = whole(1, int64_t{1} << 28);
    } else if (line == "radius_scale") {
      double x = 0;
      const auto r = std::from_chars(value.data(), value.data() + value.size(), x);
      if (r.ec != std::errc() || r.ptr != value.data() + value.size() || !(x > 0) || x > 1000)
        problem = fmt::format("{} is {}, expected a number above 0, at most 1000", line, value);
    } else if (line == "packed") {
      if (value != "true" && value != "false")
        problem = fmt::format("packed is {}, expected true or false", value);
    } else if (line == "frame.width" || line == "frame.height") {
      problem = fmt::format("{} is decided by {}", line, size);
    } else if (line.find('.') == std::string::npos) {
      problem = fmt::format("unknown line {}, expected section.key of the plan or one of {}", line,
                            listed(kStudyLines));
    } else {
      try {
        Plan plan;
        set_plan_line(plan, line + "=" + value);
      } catch (const PlanError& error) {
        problem = error.what();
      }
    }
    if (!problem.empty()) return problem;
  }
  return "";
}

Study parse_study(const std::string& text, const std::string& file, const Measures& measures) {
  return Parser(file, measures).parse(text);
}

std::vector<uint32_t> parse_numbers(const std::string& text, const std::string& option) {
  std::set<uint32_t> numbers;
  std::istringstream stream(text);
  const auto bad = [&](const std::string& part) {
    throw StudyError(fmt::format("{}: '{}', expected numbers of points as 17,23-30", option, part));
  };
  if (text.empty() || text.back() == ',') bad(text);
  for (std::string part; std::getline(stream, part, ',');) {
    uint32_t first = 0, last = 0;
    const char* end = part.data() + part.size();
    const auto a = std::from_chars(part.data(), end, first);
    if (a.ec != std::errc()) bad(part);
    last = first;
    if (a.ptr != end) {
      if (*a.ptr != '-') bad(part);
      const auto b = std::from_chars(a.ptr + 1, end, last);
      if (b.ec != std::errc() || b.ptr != end || last < first || last - first >= kMostPoints)
        bad(part);
    }
    for (uint64_t i = first; i <= last; ++i) numbers.insert(static_cast<uint32_t>(i));
    if (numbers.size() > kMostPoints) bad(part);
  }
  return {numbers.begin(), numbers.end()};
}

}  // namespace photonloom
