// SPDX-License-Identifier: Apache-2.0
#include "study/point_table.hpp"

#include <fmt/core.h>

#include <nlohmann/json.hpp>
#include <stdexcept>

namespace photonloom {

using Json = nlohmann::ordered_json;

namespace {

// The object's last member and end.
std::string end_with_check(std::string_view before) {
  return fmt::format(",\n \"check\": \"{}\"\n}}\n", checksum(before));
}

}  // namespace

std::string point_table_text(const PointTable& t) {
  Json j;
  j["study"] = t.study;
  j["source"] = t.source;
  j["seeds"] = t.seeds;
  j["measures"] = t.measures;
  j["scenes"] = Json::array();
  for (const SceneEntry& s : t.scenes)
    j["scenes"].push_back({{"name", s.name},
                           {"file", s.file},
                           {"hash", s.hash},
                           {"failure", s.failure},
                           {"references", s.references},
                           {"references_relmse", s.references_relmse}});
  j["points"] = Json::array();
  for (const PlannedPoint& p : t.points) {
    Json lines = Json::array();
    for (const auto& [line, value] : p.point.lines) lines.push_back({line, value});
    j["points"].push_back({{"point", p.point.number},
                           {"scene", p.point.scene},
                           {"origin", p.point.origin},
                           {"seeds", p.point.seeds},
                           {"lines", lines},
                           {"plan", p.plan},
                           {"command", p.command},
                           {"refused", p.refused}});
  }
  std::string text = j.dump(1, ' ', false, Json::error_handler_t::replace);
  text.resize(text.rfind("\n}"));
  return text + end_with_check(text);
}

PointTable parse_point_table(const std::string& text) {
  const std::string_view before = std::string_view(text).substr(0, text.rfind(",\n \"check\": "));
  if (text.substr(before.size()) != end_with_check(before))
    throw std::runtime_error("is damaged: its checksum does not fit");
  const Json j = Json::parse(text);
  PointTable t;
  t.study = j.at("study");
  t.source = j.at("source");
  t.seeds = j.at("seeds").get<std::vector<uint64_t>>();
  t.measures = j.at("measures").get<std::vector<std::string>>();
  for (const Json& s : j.at("scenes"))
    t.scenes.push_back({s.at("name"), s.at("file"), s.at("hash"), s.at("failure"),
                        s.at("references"), s.at("references_relmse")});
  for (const Json& p : j.at("points")) {
    PlannedPoint planned;
    planned.point.number = p.at("point");
    planned.point.scene = p.at("scene");
    planned.point.origin = p.at("origin");
    planned.point.seeds = p.at("seeds");
    for (const Json& line : p.at("lines")) planned.point.lines.emplace_back(line.at(0), line.at(1));
    planned.plan = p.at("plan");
    planned.command = p.at("command");
    planned.refused = p.at("refused");
    if (planned.point.number != t.points.size() || planned.point.scene >= t.scenes.size() ||
        planned.point.seeds < 0)
      throw std::runtime_error(
          fmt::format("has a wrong point, expected number {} of one of {} scenes", t.points.size(),
                      t.scenes.size()));
    t.points.push_back(std::move(planned));
  }
  return t;
}

}  // namespace photonloom
