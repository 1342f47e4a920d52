// SPDX-License-Identifier: Apache-2.0
// What `photonloom cosim` left.
#include <fmt/core.h>

#include <filesystem>
#include <map>
#include <stdexcept>

#include "golden/numeric/output_file.hpp"
#include "golden/plan/plan_file.hpp"
#include "golden/planner/resources.hpp"
#include "report/folder.hpp"
#include "report/layers.hpp"
#include "rtl/generate/hardware.hpp"

namespace photonloom {
namespace {

using Json = nlohmann::ordered_json;

constexpr size_t kBuckets = 240;  // of time, a unit

struct Stay {
  uint64_t in = 0, out = 0;  // cycles
};

// How full a unit was in each of kBuckets stretches of its packets' cycles.
Json utilisation(const std::string& unit, const std::vector<Stay>& stays) {
  uint64_t first = UINT64_MAX, last = 0, latency = 0;
  for (const Stay& s : stays) {
    first = std::min(first, s.in);
    last = std::max(last, s.out);
    latency += s.out - s.in;
  }
  const uint64_t span = last - first + 1, width = (span + kBuckets - 1) / kBuckets,
                 count = (span + width - 1) / width;
  // Packets that come in less those that go out, by cycle.
  std::map<uint64_t, int64_t> steps;
  for (const Stay& s : stays) {
    ++steps[s.in - first];
    --steps[s.out - first + 1];
  }
  std::vector<double> busy(count), inside(count);
  int64_t level = 0;
  uint64_t at = 0;
  const auto spread = [&](uint64_t to) {
    while (level > 0 && at < to) {
      const uint64_t bucket = at / width, end = std::min(to, (bucket + 1) * width);
      busy[bucket] += static_cast<double>(end - at);
      inside[bucket] += static_cast<double>(end - at) * static_cast<double>(level);
      at = end;
    }
    at = to;
  };
  for (const auto& [cycle, step] : steps) {
    spread(cycle);
    level += step;
  }
  Json busy_part = Json::array(), inside_mean = Json::array();
  for (uint64_t b = 0; b < count; ++b) {
    const auto cycles = static_cast<double>(std::min(width, span - b * width));
    busy_part.push_back(busy[b] / cycles);
    inside_mean.push_back(inside[b] / cycles);
  }
  return {{"unit", unit},
          {"packets", stays.size()},
          {"first", first},
          {"last", last},
          {"bucket", width},
          {"latency", static_cast<double>(latency) / static_cast<double>(stays.size())},
          {"busy", busy_part},
          {"inside", inside_mean}};
}

Json read_timeline(const std::string& path) {
  const Json file = read_object(path);
  std::map<int, std::string> units;
  std::map<int, std::map<uint64_t, Stay>> stays;
  try {
    for (const Json& e : file.at("traceEvents")) {
      const std::string phase = e.at("ph").get<std::string>();
      const int process = e.at("pid").get<int>();
      if (phase == "M")
        units[process] = e.at("args").at("name").get<std::string>();
      else if (phase == "b")
        stays[process][e.at("id").get<uint64_t>()].in = e.at("ts").get<uint64_t>();
      else if (phase == "e")
        stays[process][e.at("id").get<uint64_t>()].out = e.at("ts").get<uint64_t>();
    }
  } catch (const Json::exception&) {
    throw std::runtime_error(fmt::format(
        "{}: is damaged, expected traceEvents with ph, pid, id and ts as cosim writes them", path));
  }
  Json all = Json::array();
  for (const auto& [process, packets] : stays) {
    std::vector<Stay> list;
    for (const auto& [id, stay] : packets) {
      if (stay.out < stay.in)
        throw std::runtime_error(
            fmt::format("{}: packet {} of {} leaves before it comes", path, id, units[process]));
      list.push_back(stay);
    }
    all.push_back(utilisation(units[process], list));
  }
  return all;
}

// Streams without their rows, which are a payload.
Json read_packets(const std::string& path, Payloads& payloads) {
  Json file = read_object(path);
  try {
    for (Json& stream : file.at("streams")) {
      size_t elements = 0;
      for (const Json& f : stream.at("fields")) {
        elements += f.at("elements").get<size_t>();
        for (const char* name : {"name", "bits", "used", "most", "unit", "meaning"}) f.at(name);
      }
      for (const Json& row : stream.at("rows"))
        if (row.size() != elements) throw std::runtime_error("");
      stream["kept"] = stream.at("rows").size();
      stream["payload"] = payloads.add(stream.at("rows").dump());
      stream.at("unit").get<std::string>();
      stream.at("stream").get<std::string>();
      stream.at("count").get<uint64_t>();
      stream.erase("rows");
    }
    return file.at("streams");
  } catch (const std::exception&) {
    throw std::runtime_error(fmt::format(
        "{}: is damaged, expected streams with fields and rows as cosim writes them", path));
  }
}

Json resources_of(const Plan& plan) {
  Json units = Json::array();
  for (const std::string& unit : units_present(plan)) {
    if (!is_predicted(unit)) continue;
    const UnitResources r = estimate_resources(plan, unit);
    Json entry = {{"unit", unit}};
    const std::pair<const char*, double> figures[] = {
        {"lut", r.lut}, {"ff", r.ff}, {"dsp", r.dsp}, {"ebr", r.ebr}};
    for (const auto& [name, value] : figures)
      entry[name] = {{"value", value}, {"error", resource_error(unit, name)}};
    units.push_back(entry);
  }
  return units;
}

}  // namespace

bool is_run(const std::string& folder) {
  return std::filesystem::exists(folder + "/golden.exr") ||
         std::filesystem::exists(folder + "/timeline.json");
}

Json run_json(const std::string& folder, const std::vector<ExtraImage>& extra, Payloads& payloads) {
  const std::string path = folder + "/summary.json";
  const Json summary = read_object(path);
  for (const char* name :
       {"scene", "plan_hash", "units", "packets", "differences", "images_identical"})
    member(summary, name, path);
  const std::string scene = summary.at("scene").get<std::string>();
  std::string name = std::filesystem::path(scene).stem().string();
  const std::string hardware = summary.value("hardware", std::string("rtl"));
  ImageSet images(kRunMantissa, payloads);
  images.expect_size_of(folder + "/golden.exr");
  for (const ExtraImage& e : extra)
    if (e.scene == name) images.add_file(e.label, e.file, "given with --image");
  if (std::filesystem::exists(folder + "/reference.exr"))
    images.add_file("reference", folder + "/reference.exr",
                    "double arithmetic on the same photons, queries and directions");
  images.add_file("golden", folder + "/golden.exr", "exact integers in the plan's formats");
  images.add_file(hardware, folder + "/" + hardware + ".exr",
                  "the frame with the units that the summary names as hardware");
  const std::string plan_file = folder + "/plan.toml";
  const Json plan = read_plan_lines(plan_file);
  if (plan.at("hash") != summary.at("plan_hash"))
    throw std::runtime_error(fmt::format("{}: has the hash {}, expected {} of {}", plan_file,
                                         plan.at("hash").get<std::string>(),
                                         summary.at("plan_hash").get<std::string>(), path));
  Json run = {{"name", name},
              {"folder", folder},
              {"hardware", hardware},
              {"summary", summary},
              {"plan", plan},
              {"plan_text", payloads.add(read_file(plan_file))},
              {"resources", resources_of(read_plan(plan_file))},
              {"images", images.json()},
              {"utilisation", read_timeline(folder + "/timeline.json")}};
  const std::string packets = folder + "/packets.json";
  run["streams"] = std::filesystem::exists(packets) ? read_packets(packets, payloads) : Json();
  return run;
}

}  // namespace photonloom
