// SPDX-License-Identifier: Apache-2.0
#include "study/point_table.hpp"

#include <nlohmann/json.hpp>

namespace photonloom {

using Json = nlohmann::ordered_json;

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
  return j.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

PointTable parse_point_table(const std::string& text) {
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
    t.points.push_back(std::move(planned));
  }
  return t;
}

}  // namespace photonloom
