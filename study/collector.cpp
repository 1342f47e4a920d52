// SPDX-License-Identifier: Apache-2.0
#include "study/collector.hpp"

#include <fmt/core.h>
#include <oneapi/tbb/parallel_for.h>
#include <sqlite3.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <stdexcept>

#include "golden/numeric/output_file.hpp"
#include "golden/numeric/text.hpp"

namespace photonloom {
namespace {

using Json = nlohmann::ordered_json;

// What fronts trade for error.
struct Front {
  const char *name, *cost;
};
constexpr Front kFronts[] = {{"cycles", "gather.cycles"},
                             {"lut", "resources.gatherer_lut"},
                             {"bytes", "gather.bytes"},
                             {"map", "resources.map_bytes"}};
constexpr const char* kErrors[] = {"visible.relmse", "formats.relmse"};  // the first that there is

// One figure's seeds; blocks of a point and of its baseline, where there are any.
struct Series {
  std::vector<double> value;
  std::vector<const Blocks*> blocks;
};

// Of equal numbers exactly that number, so that their variance is 0.
double mean(const std::vector<double>& v) {
  if (v.empty()) return kNoValue;
  double sum = 0;
  for (const double x : v) sum += x - v[0];
  return v[0] + sum / static_cast<double>(v.size());
}

// Variance of the mean of independent numbers.
double variance_of_mean(const std::vector<double>& v) {
  if (v.size() < 2) return kNoValue;
  const double m = mean(v), n = static_cast<double>(v.size());
  double sum = 0;
  for (const double x : v) sum += (x - m) * (x - m);
  return sum / (n - 1) / n;
}

// Of sum over blocks of (a - r b), each block varying from seed to seed by itself.
double blockwise_error(const Series& a, const Series* b, double r) {
  const size_t seeds = a.value.size();
  const bool cut =
      std::all_of(a.blocks.begin(), a.blocks.end(), [](auto* x) { return x; }) &&
      (!b || std::all_of(b->blocks.begin(), b->blocks.end(), [](auto* x) { return x; }));
  const size_t blocks = cut ? a.blocks[0]->size() : 1;
  double variance = 0;
  std::vector<double> v(seeds);
  for (size_t j = 0; j < blocks; ++j) {
    for (size_t i = 0; i < seeds; ++i) {
      v[i] = cut ? (*a.blocks[i])[j] : a.value[i];
      if (b) v[i] -= r * (cut ? (*b->blocks[i])[j] : b->value[i]);
    }
    variance += variance_of_mean(v);
  }
  return std::sqrt(variance);
}

std::string number(double x) { return std::isfinite(x) ? fmt::format("{}", x) : ""; }
Json json_number(double x) { return std::isfinite(x) ? Json(x) : Json(); }

class Database {
 public:
  explicit Database(const std::string& path) : path_(path), temporary_(path + ".partial-sqlite") {
    std::error_code ignored;
    std::filesystem::remove(temporary_, ignored);
    if (sqlite3_open(temporary_.c_str(), &db_) != SQLITE_OK) fail();
    run("PRAGMA journal_mode=OFF");
    run("PRAGMA synchronous=OFF");
    run("BEGIN");
  }
  ~Database() {
    statement_.reset();
    sqlite3_close(db_);
    std::error_code ignored;
    std::filesystem::remove(temporary_, ignored);
  }

  void run(const std::string& sql) {
    if (sqlite3_exec(db_, sql.c_str(), nullptr, nullptr, nullptr) != SQLITE_OK) fail();
  }

  // A table, into which the rows that follow go.
  void table(const std::string& name, const std::vector<std::string>& columns) {
    std::string list, marks;
    for (const std::string& c : columns) {
      list += (list.empty() ? "" : ", ") + c;
      marks += marks.empty() ? "?" : ",?";
    }
    run(fmt::format("CREATE TABLE {} ({})", name, list));
    sqlite3_stmt* statement = nullptr;
    if (sqlite3_prepare_v2(db_, fmt::format("INSERT INTO {} VALUES ({})", name, marks).c_str(), -1,
                           &statement, nullptr) != SQLITE_OK)
      fail();
    statement_.reset(statement);
    next_ = 1;
  }
  void integer(uint64_t value) {
    sqlite3_bind_int64(statement_.get(), next_++, static_cast<sqlite3_int64>(value));
  }
  void real(double value) {
    if (std::isfinite(value))
      sqlite3_bind_double(statement_.get(), next_++, value);
    else
      sqlite3_bind_null(statement_.get(), next_++);
  }
  void text(const std::string& value) {
    sqlite3_bind_text(statement_.get(), next_++, value.c_str(), -1, SQLITE_TRANSIENT);
  }
  void end_row() {
    if (sqlite3_step(statement_.get()) != SQLITE_DONE) fail();
    sqlite3_reset(statement_.get());
    next_ = 1;
  }

  void commit() {
    statement_.reset();
    run("COMMIT");
    if (sqlite3_close(db_) != SQLITE_OK) fail();
    db_ = nullptr;
    std::error_code error;
    std::filesystem::rename(temporary_, path_, error);
    if (error)
      throw std::runtime_error(
          fmt::format("{}: cannot be put in place ({}), expected a database of a sweep, or nothing",
                      path_, error.message()));
  }

 private:
  [[noreturn]] void fail() const {
    throw std::runtime_error(fmt::format("{}: cannot be written: {}", path_, sqlite3_errmsg(db_)));
  }

  struct Finalise {
    void operator()(sqlite3_stmt* s) const { sqlite3_finalize(s); }
  };
  std::string path_, temporary_;
  sqlite3* db_ = nullptr;
  std::unique_ptr<sqlite3_stmt, Finalise> statement_;
  int next_ = 1;
};

struct Collected {
  std::string state, reason;
  Means means;
  std::vector<Result> results;
  std::vector<std::string> fronts;
};

// What the store holds of a point: its state and results, with their blocks.
Collected stored_results(const PointTable& table, const PlannedPoint& p, const ResultStore& store,
                         const Completeness& complete) {
  Collected to;
  const SceneEntry& scene = table.scenes[p.point.scene];
  if (!p.refused.empty()) {
    to.state = "refused";
    to.reason = p.refused;
    return to;
  }
  if (!scene.failure.empty()) {
    to.state = "failed";
    to.reason = scene.failure;
    return to;
  }
  if (p.plan.empty()) {
    to.state = "missing";
    return to;
  }
  to.state = "done";
  for (const uint64_t seed : seeds_of(p.point, table.seeds)) {
    std::optional<Result> r;
    try {
      r = store.find({scene.hash, p.plan, seed});
    } catch (const std::runtime_error&) {  // the runner has said so
    }
    if (!r) {
      if (to.state == "done") to.state = "missing";
      continue;
    }
    // Another study on this folder may have measured more.
    std::erase_if(r->measures, [&](const auto& m) {
      return std::find(table.measures.begin(), table.measures.end(), m.first) ==
             table.measures.end();
    });
    const bool whole = complete(p, *r);
    if (!whole && !r->failure.empty()) {
      to.state = "failed";
      to.reason = r->failure;
    } else if (!whole && to.state == "done") {
      to.state = "missing";
    }
    if (whole || !r->measures.empty()) to.results.push_back(std::move(*r));
  }
  return to;
}

// Of each scene the points that no other beats in both error and cost.
void find_fronts(const PointTable& table, std::vector<Collected>& points) {
  for (const Front& front : kFronts)
    for (size_t scene = 0; scene < table.scenes.size(); ++scene) {
      struct At {
        double cost, error;
        size_t point;
      };
      std::vector<At> all;
      // Points may have seeds of different numbers; ratios compare each with the baseline over its
      // own.
      const auto figure = [](const Mean& m) { return std::isfinite(m.ratio) ? m.ratio : m.mean; };
      for (size_t i = 0; i < points.size(); ++i) {
        if (table.points[i].point.scene != scene || points[i].state != "done") continue;
        const Means& m = points[i].means;
        const auto cost = m.find(front.cost);
        for (const char* error : kErrors)
          if (const auto e = m.find(error); e != m.end()) {
            if (cost != m.end() && std::isfinite(cost->second.mean) &&
                std::isfinite(e->second.mean))
              all.push_back({figure(cost->second), figure(e->second), i});
            break;
          }
      }
      std::sort(all.begin(), all.end(), [](const At& a, const At& b) {
        return std::tie(a.cost, a.error, a.point) < std::tie(b.cost, b.error, b.point);
      });
      double least = std::numeric_limits<double>::infinity();
      for (const At& at : all)
        if (at.error < least) {
          least = at.error;
          points[at.point].fronts.emplace_back(front.name);
        }
    }
}

void write_database(const PointTable& table, const std::vector<Collected>& points,
                    const std::string& path) {
  Database db(path);
  db.table("scenes",
           {"scene TEXT", "hash TEXT", "file TEXT", "failure TEXT", "reference_relmse REAL"});
  for (const SceneEntry& s : table.scenes) {
    for (const std::string& t : {s.name, s.hash, s.file, s.failure}) db.text(t);
    db.real(s.references.empty() ? kNoValue : s.references_relmse);
    db.end_row();
  }
  db.table("points", {"point INTEGER PRIMARY KEY", "scene TEXT", "plan TEXT", "origin TEXT",
                      "state TEXT", "reason TEXT", "command TEXT"});
  for (size_t i = 0; i < points.size(); ++i) {
    const PlannedPoint& p = table.points[i];
    db.integer(p.point.number);
    for (const std::string& t : {table.scenes[p.point.scene].name, p.plan, p.point.origin,
                                 points[i].state, points[i].reason, p.command})
      db.text(t);
    db.end_row();
  }
  db.table("lines", {"point INTEGER", "line TEXT", "value TEXT"});
  for (const PlannedPoint& p : table.points)
    for (const auto& [line, value] : p.point.lines) {
      db.integer(p.point.number);
      db.text(line);
      db.text(value);
      db.end_row();
    }
  for (const std::string& name : table.measures) {
    std::vector<std::string> columns = {"point INTEGER", "seed INTEGER"};
    for (const Column& c : measure(name).columns) columns.push_back(std::string(c.name) + " REAL");
    db.table(name, columns);
    for (size_t i = 0; i < points.size(); ++i)
      for (const Result& r : points[i].results) {
        const auto taken = r.measures.find(name);
        if (taken == r.measures.end()) continue;
        db.integer(table.points[i].point.number);
        db.integer(r.key.seed);
        for (const double v : taken->second.figures.values) db.real(v);
        db.end_row();
      }
  }
  db.table("means", {"point INTEGER", "measure TEXT", "name TEXT", "mean REAL",
                     "standard_error REAL", "ratio REAL", "ratio_error REAL"});
  for (size_t i = 0; i < points.size(); ++i)
    for (const auto& [name, m] : points[i].means) {
      const size_t dot = name.find('.');
      db.integer(table.points[i].point.number);
      db.text(name.substr(0, dot));
      db.text(name.substr(dot + 1));
      for (const double v : {m.mean, m.error, m.ratio, m.ratio_error}) db.real(v);
      db.end_row();
    }
  db.commit();
}

std::vector<std::string> figures_of(const PointTable& table) {
  std::vector<std::string> names;
  for (const std::string& name : table.measures)
    for (const Column& c : measure(name).columns) names.push_back(name + "." + c.name);
  return names;
}

void write_csv(const PointTable& table, const std::vector<Collected>& points,
               const std::string& path) {
  std::vector<std::string> lines;
  for (const PlannedPoint& p : table.points)
    for (const auto& [line, value] : p.point.lines)
      if (std::find(lines.begin(), lines.end(), line) == lines.end()) lines.push_back(line);
  const std::vector<std::string> figures = figures_of(table);
  OutputFile out(path);
  std::string row = "point,scene,plan,origin,state";
  for (const std::string& line : lines) row += "," + csv_field(line);
  for (const std::string& f : figures)
    row += fmt::format(",{0},{0}.error,{0}.ratio,{0}.ratio_error", f);
  out.write(row + "\n");
  for (size_t i = 0; i < points.size(); ++i) {
    const PlannedPoint& p = table.points[i];
    row = fmt::format("{},{},{},{},{}", p.point.number, csv_field(table.scenes[p.point.scene].name),
                      p.plan, csv_field(p.point.origin), points[i].state);
    for (const std::string& line : lines) {
      std::string value;
      for (const auto& [l, v] : p.point.lines)
        if (l == line) value = v;
      row += "," + csv_field(value);
    }
    for (const std::string& f : figures) {
      const auto m = points[i].means.find(f);
      if (m == points[i].means.end())
        row += ",,,,";
      else
        row += fmt::format(",{},{},{},{}", number(m->second.mean), number(m->second.error),
                           number(m->second.ratio), number(m->second.ratio_error));
    }
    out.write(row + "\n");
  }
  out.commit();
}

void write_summary(const PointTable& table, const std::vector<Collected>& points,
                   const std::string& path) {
  Json head;
  head["study"] = table.study;
  head["seeds"] = table.seeds;
  head["scenes"] = Json::array();
  for (size_t s = 0; s < table.scenes.size(); ++s) {
    const SceneEntry& scene = table.scenes[s];
    const auto baseline = std::find_if(table.points.begin(), table.points.end(),
                                       [&](const PlannedPoint& p) { return p.point.scene == s; });
    head["scenes"].push_back(
        {{"scene", scene.name},
         {"file", scene.file},
         {"hash", scene.hash},
         {"failure", scene.failure},
         {"baseline", baseline == table.points.end() ? Json() : Json(baseline->point.number)},
         {"reference_relmse", scene.references.empty() ? Json() : Json(scene.references_relmse)}});
  }
  head["measures"] = Json::array();
  for (const std::string& name : table.measures) {
    Json columns = Json::array();
    for (const Column& c : measure(name).columns)
      columns.push_back({{"name", c.name}, {"unit", c.unit}, {"meaning", c.meaning}});
    head["measures"].push_back(
        {{"measure", name}, {"meaning", measure(name).meaning}, {"columns", columns}});
  }
  head["fronts"] = Json::array();
  for (const Front& f : kFronts) head["fronts"].push_back({{"front", f.name}, {"cost", f.cost}});
  // Point by point: there may be many.
  OutputFile out(path);
  std::string text = head.dump(1, ' ', false, Json::error_handler_t::replace);
  text.resize(text.rfind('}'));
  while (!text.empty() && text.back() == '\n') text.pop_back();
  out.write(text + ",\n \"points\": [");
  for (size_t i = 0; i < points.size(); ++i) {
    const PlannedPoint& p = table.points[i];
    Json j;
    j["point"] = p.point.number;
    j["scene"] = table.scenes[p.point.scene].name;
    j["plan"] = p.plan;
    j["origin"] = p.point.origin;
    j["state"] = points[i].state;
    j["seeds"] = seeds_of(p.point, table.seeds).size();
    if (!points[i].reason.empty()) j["reason"] = points[i].reason;
    j["lines"] = Json::object();
    for (const auto& [line, value] : p.point.lines) j["lines"][line] = value;
    j["command"] = p.command;
    j["front"] = points[i].fronts;
    j["values"] = Json::object();
    for (const std::string& f : figures_of(table))
      if (const auto m = points[i].means.find(f); m != points[i].means.end())
        j["values"][f] = {{"mean", json_number(m->second.mean)},
                          {"error", json_number(m->second.error)},
                          {"ratio", json_number(m->second.ratio)},
                          {"ratio_error", json_number(m->second.ratio_error)}};
    out.write((i == 0 ? "\n  " : ",\n  ") + j.dump(-1, ' ', false, Json::error_handler_t::replace));
  }
  out.write("\n ]\n}\n");
  out.commit();
}

void write_host(const PointTable& table, const std::vector<Collected>& points,
                const std::string& path) {
  OutputFile out(path);
  out.write("point,seed,seconds\n");
  for (size_t i = 0; i < points.size(); ++i)
    for (const Result& r : points[i].results)
      out.write(fmt::format("{},{},{:.3f}\n", table.points[i].point.number, r.key.seed, r.seconds));
  out.commit();
}

}  // namespace

Means means_of(const std::vector<Result>& results, const std::vector<Result>& baseline) {
  Means means;
  if (results.empty()) return means;
  // A result may lack what others have.
  std::set<std::string> names;
  for (const Result& r : results)
    for (const auto& [name, taken] : r.measures) names.insert(name);
  for (const std::string& name : names) {
    const std::vector<Column>& columns = measure(name).columns;
    for (size_t c = 0; c < columns.size(); ++c) {
      Series all, a, b;  // every seed of the point; those that the baseline has too
      const auto add = [&](Series& to, const Result& r) {
        const auto taken = r.measures.find(name);
        if (taken == r.measures.end() || c >= taken->second.figures.values.size()) return false;
        to.value.push_back(taken->second.figures.values[c]);
        const auto blocks = taken->second.figures.blocks.find(columns[c].name);
        to.blocks.push_back(blocks == taken->second.figures.blocks.end() ? nullptr
                                                                         : &blocks->second);
        return true;
      };
      for (const Result& r : results) {
        if (!add(all, r)) continue;
        const auto same = std::find_if(baseline.begin(), baseline.end(),
                                       [&](const Result& x) { return x.key.seed == r.key.seed; });
        if (same != baseline.end() && add(b, *same)) add(a, r);
      }
      Mean m{mean(all.value), blockwise_error(all, nullptr, 0), kNoValue, kNoValue};
      if (!b.value.empty() && mean(b.value) != 0) {
        m.ratio = mean(a.value) / mean(b.value);
        m.ratio_error = blockwise_error(a, &b, m.ratio) / std::fabs(mean(b.value));
      }
      means[name + "." + columns[c].name] = m;
    }
  }
  return means;
}

CollectReport collect(const PointTable& table, const ResultStore& store,
                      const Completeness& complete, Progress* progress) {
  const ProgressPhase phase(progress, "collect", table.points.size(), "points");
  std::vector<Collected> points(table.points.size());
  // A scene's points stand together, its baseline first.
  std::vector<std::vector<Result>> baselines;
  std::vector<size_t> baseline_of(points.size());
  for (size_t i = 0; i < points.size(); ++i) {
    if (i == 0 || table.points[i - 1].point.scene != table.points[i].point.scene)
      baselines.push_back(stored_results(table, table.points[i], store, complete).results);
    baseline_of[i] = baselines.size() - 1;
  }
  tbb::parallel_for(size_t{0}, points.size(), [&](size_t i) {
    Collected& to = points[i];
    to = stored_results(table, table.points[i], store, complete);
    to.means = means_of(to.results, baselines[baseline_of[i]]);
    for (Result& r : to.results)
      for (auto& [name, taken] : r.measures) taken.figures.blocks.clear();
    phase.advance(1);
  });
  CollectReport report;
  for (const Collected& point : points) {
    report.results += point.results.size();
    report.missing += point.state == "missing";
    report.failed += point.state == "failed";
    report.refused += point.state == "refused";
  }
  report.points = points.size();
  find_fronts(table, points);
  const std::string& folder = store.folder();
  write_database(table, points, folder + "/results.sqlite");
  write_csv(table, points, folder + "/results.csv");
  write_summary(table, points, folder + "/summary.json");
  write_host(table, points, folder + "/host.csv");
  return report;
}

}  // namespace photonloom
