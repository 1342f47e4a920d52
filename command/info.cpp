// SPDX-License-Identifier: Apache-2.0
// photonloom info SCENE: what is in a scene, and what hardware it would need.
#include <fmt/core.h>

#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>

#include "command/command.hpp"
#include "command/json_text.hpp"
#include "command/scene_option.hpp"
#include "golden/plan/units.hpp"
#include "golden/planner/planner.hpp"
#include "golden/transport/world.hpp"

namespace photonloom {
namespace {

using Json = nlohmann::ordered_json;

const char* name(BsdfKind kind) {
  switch (kind) {
    case BsdfKind::kDiffuse:
      return "diffuse";
    case BsdfKind::kPhong:
      return "phong";
    case BsdfKind::kConductor:
      return "conductor";
    case BsdfKind::kDielectric:
      return "dielectric";
    case BsdfKind::kThinDielectric:
      return "thindielectric";
    case BsdfKind::kRoughConductor:
      return "roughconductor";
    case BsdfKind::kRoughDielectric:
      return "roughdielectric";
    case BsdfKind::kPlastic:
      return "plastic";
    case BsdfKind::kRoughPlastic:
      return "roughplastic";
    case BsdfKind::kPrincipled:
      return "principled";
    default:
      return "mixture";
  }
}

const char* name(LightKind kind) {
  switch (kind) {
    case LightKind::kPoint:
      return "point";
    case LightKind::kSpot:
      return "spot";
    case LightKind::kDirectional:
      return "directional";
    case LightKind::kCollimated:
      return "collimated";
    default:
      return "environment";
  }
}

const char* name(ShapeKind kind) {
  constexpr const char* kNames[] = {"mesh", "sphere", "disk", "rectangle", "cube", "cylinder"};
  return kNames[static_cast<size_t>(kind)];
}

Json triple(const Vec3& v) { return {v.x, v.y, v.z}; }

// Whether no photon can have another colour than the others: emission of everything in one colour
// keeps photons in it where every surface is grey. The planner, which has the photons, may find one
// colour in other scenes too.
bool one_color(const World& world) {
  const auto parallel = [](const Rgb& a, const Rgb& b) { return glm::cross(a, b) == Rgb(0); };
  const Scene& s = world.scene();
  const auto colored = [&](int texture) {
    if (texture < 0) return false;
    const Texture& t = s.textures[static_cast<size_t>(texture)];
    if (t.kind == TextureKind::kCheckerboard)
      return !parallel(t.color[0] * t.scale, Rgb(1)) || !parallel(t.color[1] * t.scale, Rgb(1));
    return t.kind == TextureKind::kVertexColor || t.bitmap->channels > 1 ||
           !parallel(t.scale, Rgb(1));
  };
  const auto grey = [&](const auto& again, int index) -> bool {
    if (index < 0) return true;
    const Bsdf& b = s.bsdfs[static_cast<size_t>(index)];
    for (const Rgb& c :
         {b.diffuse, b.specular, b.transmission, b.eta, b.k, b.coat_specular, b.coat_absorption})
      if (!parallel(c, Rgb(1))) return false;
    return std::none_of(b.texture.begin(), b.texture.end(), colored) &&
           std::all_of(b.parts.begin(), b.parts.end(),
                       [&](int part) { return again(again, part); });
  };
  for (const Emitter& e : world.emitters())
    if (!parallel(e.power, world.emitters()[0].power) || colored(e.texture)) return false;
  for (const Light& l : s.lights)
    if (l.map && l.map->channels > 1) return false;
  for (const Shape& shape : s.shapes)
    for (const int side : {shape.bsdf, shape.back_bsdf})
      if (!grey(grey, side)) return false;
  return true;
}

const char* name(CameraKind kind) {
  constexpr const char* kNames[] = {"perspective", "thinlens", "orthographic"};
  return kNames[static_cast<size_t>(kind)];
}

const char* name(FilterKind kind) {
  constexpr const char* kNames[] = {"box", "tent", "gaussian", "mitchell", "lanczos"};
  return kNames[static_cast<size_t>(kind)];
}

// What of a BSDF the hardware sees; photons only where a surface of the scene gathers them.
Json reaches(const Scene& scene, const Bsdf& b, bool gathered) {
  Json out = Json::array();
  if (has_diffuse_part(scene, &b)) out.push_back("queries and photons of its diffuse lobe");
  if (gathered && has_delta_part(scene, &b)) out.push_back("caustic photons that it throws");
  if (b.follow_diffuse && !is_black(b.diffuse))
    out.push_back("nothing of its diffuse lobe: the map has another coat's, the host follows it");
  if (out.empty()) out.push_back("nothing: the host follows its light");
  return out;
}

Json describe(const World& world) {
  const Scene& s = world.scene();
  Json j;
  j["scene"] = s.name;
  j["hash"] = fmt::format("{:016x}", s.hash);
  j["film"] = {{"width", s.film.width},
               {"height", s.film.height},
               {"filter", name(s.film.filter.kind)},
               {"filter_radius", s.film.filter.radius}};
  if (s.film.is_window()) {
    j["film"]["left"] = s.film.left;
    j["film"]["top"] = s.film.top;
    j["film"]["of"] = {s.film.whole_width, s.film.whole_height};
  }
  j["camera"] = name(s.camera.kind);
  j["max_depth"] = s.max_depth;
  j["bounds"] = {{"lower", triple(world.lower())}, {"upper", triple(world.upper())}};
  j["cube"] = {{"origin", triple(world.cube_origin())}, {"extent", world.cube_extent()}};
  j["surface_area"] = world.surface_area();
  uint64_t triangles = 0;
  Json shapes = Json::array();
  for (const Shape& shape : s.shapes) {
    triangles += shape.mesh.triangles.size();
    Json entry = {{"id", shape.id}, {"type", name(shape.kind)}};
    if (!shape.mesh.triangles.empty()) entry["triangles"] = shape.mesh.triangles.size();
    const Bsdf& b = s.bsdfs[static_cast<size_t>(shape.bsdf)];
    entry["bsdf"] = b.id.empty() ? std::string(name(b.kind)) : b.id;
    entry["two_sided"] = shape.back_bsdf >= 0;
    if (shape.radiance) entry["radiance"] = triple(*shape.radiance);
    shapes.push_back(entry);
  }
  j["triangles"] = triangles;
  j["primitives"] = world.primitives().size();
  uint64_t instanced = 0;
  for (const PlacedGroup& g : world.instances()) {
    const World::Range range = world.groups()[g.group];
    instanced += range.end - range.begin;
  }
  j["instances"] = world.instances().size();
  j["instanced_triangles"] = instanced;
  j["shapes"] = shapes;
  // What asks a photon map needs the units that answer; a scene of mirrors and lamps needs none.
  const MapsNeeded maps = maps_needed(world, 1);
  Json bsdfs = Json::array();
  const std::vector<bool> used = used_bsdfs(s);
  for (size_t i = 0; i < s.bsdfs.size(); ++i)
    if (const Bsdf& b = s.bsdfs[i]; used[i])
      bsdfs.push_back(
          {{"id", b.id}, {"type", name(b.kind)}, {"hardware", reaches(s, b, maps.global)}});
  j["bsdfs"] = bsdfs;
  // Area emitters by shape: a mesh is many emitting primitives.
  Json emitters = Json::array();
  for (size_t i = 0; i < s.shapes.size(); ++i) {
    if (!s.shapes[i].radiance) continue;
    Rgb power(0);
    for (const Emitter& e : world.emitters())
      if (e.primitive >= 0 && world.primitives()[static_cast<size_t>(e.primitive)].shape == i)
        power += e.power;
    emitters.push_back({{"type", "area"}, {"shape", s.shapes[i].id}, {"power", triple(power)}});
  }
  for (const Emitter& e : world.emitters())
    if (e.light >= 0)
      emitters.push_back({{"type", name(s.lights[static_cast<size_t>(e.light)].kind)},
                          {"power", triple(e.power)}});
  j["emitters"] = emitters;
  j["power"] = triple(world.emitted_power());
  Json units = Json::array();
  Plan frame;
  frame.global.present = maps.global;
  if (maps.global) {
    for (const std::string& unit : units_present(frame)) units.push_back(unit);
    units.push_back("shader");
  }
  j["needs"] = {{"units", units},
                {"global_map", maps.global},
                {"caustic_map", maps.caustic},
                {"glossy_lobes", world.has_glossy()},
                {"channels_at_most", one_color(world) ? 1 : 3}};
  j["warnings"] = s.warnings;
  return j;
}

std::string list(const Json& j) {
  return fmt::format("{:.6g} {:.6g} {:.6g}", j[0].get<double>(), j[1].get<double>(),
                     j[2].get<double>());
}

void print(const Json& j) {
  fmt::print("scene      {}, hash {}\n", j["scene"].get<std::string>(),
             j["hash"].get<std::string>());
  const Json& film = j["film"];
  fmt::print("film       {} x {}, {} filter of radius {:g}{}\n", film["width"].get<int>(),
             film["height"].get<int>(), film["filter"].get<std::string>(),
             film["filter_radius"].get<double>(),
             film.contains("of")
                 ? fmt::format(", at {:g} {:g} of {:g} x {:g}", film["left"].get<double>(),
                               film["top"].get<double>(), film["of"][0].get<double>(),
                               film["of"][1].get<double>())
                 : "");
  fmt::print("camera     {}\n", j["camera"].get<std::string>());
  const int depth = j["max_depth"].get<int>();
  fmt::print("paths      {}\n",
             depth < 0 ? "of any length" : fmt::format("of at most {} segments", depth));
  fmt::print("bounds     {} to {}\n", list(j["bounds"]["lower"]), list(j["bounds"]["upper"]));
  fmt::print("surfaces   {} shapes, {} triangles, {} primitives, area {:.6g}\n", j["shapes"].size(),
             j["triangles"].get<uint64_t>(), j["primitives"].get<uint64_t>(),
             j["surface_area"].get<double>());
  if (j["instances"].get<uint64_t>() > 0)
    fmt::print("instances  {} with {} triangles\n", j["instances"].get<uint64_t>(),
               j["instanced_triangles"].get<uint64_t>());
  for (const Json& s : j["shapes"])
    fmt::print("  {:<10} {:<16} {}{}{}\n", s["type"].get<std::string>(), s["id"].get<std::string>(),
               s["bsdf"].get<std::string>(), s["two_sided"].get<bool>() ? ", both sides" : "",
               s.contains("triangles")
                   ? fmt::format(", {} triangles", s["triangles"].get<uint64_t>())
                   : "");
  fmt::print("emitters   {} W (R G B)\n", list(j["power"]));
  for (const Json& e : j["emitters"])
    fmt::print("  {:<10} {:<16} {} W\n", e["type"].get<std::string>(), e.value("shape", ""),
               list(e["power"]));
  const Json& needs = j["needs"];
  const auto yes = [](const Json& b) { return b.get<bool>() ? "yes" : "no"; };
  std::string units;
  for (const Json& unit : needs["units"])
    units += (units.empty() ? "" : ", ") + unit.get<std::string>();
  fmt::print("units      {}\n", units.empty() ? "none" : units);
  fmt::print("needs      global map {}, caustic map {}, glossy lobes {}, {} of power\n",
             yes(needs["global_map"]), yes(needs["caustic_map"]), yes(needs["glossy_lobes"]),
             needs["channels_at_most"].get<int>() == 1 ? "1 channel" : "at most 3 channels");
  for (const Json& b : j["bsdfs"]) {
    if (b["type"] == "diffuse") continue;  // all of it
    std::string parts;
    for (const Json& part : b["hardware"])
      parts += (parts.empty() ? "" : ", ") + part.get<std::string>();
    const std::string id = b["id"].get<std::string>();
    fmt::print("hardware   {}{}: {}\n", b["type"].get<std::string>(), id.empty() ? "" : " " + id,
               parts);
  }
  for (const Json& w : j["warnings"]) fmt::print("warning    {}\n", w.get<std::string>());
}

void add_info(CLI::App& app) {
  struct Options {
    SceneOption scene;
    bool json = false;
  };
  auto o = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("info", "What is in a scene, and what hardware it needs");
  command->footer(
      "What it needs is told from the file alone, for a frame with final gather rays; `photonloom\n"
      "plan`, which traces the photons, needs no unit of a map in which none is stored, and finds\n"
      "1 channel of power also where the file allows 3 and all photons have one colour.\n\n"
      "Example: photonloom info scenes/cornell.xml --json");
  o->scene.add_to(*command);
  command->add_flag("--json", o->json, "One JSON object instead of text");
  command->callback([o] {
    const auto started = std::chrono::steady_clock::now();
    const World world(o->scene.load());
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - started;
    const Json j = describe(world);
    if (o->json) {
      fmt::print("{}\n", json_text(j));
    } else {
      print(j);
      rusage usage{};
      getrusage(RUSAGE_SELF, &usage);
      fmt::print("loaded     in {:.2f} s, {:.0f} MiB at most\n", seconds.count(),
                 static_cast<double>(usage.ru_maxrss) / 1024);
    }
  });
}

const Command info_command(10, add_info);

}  // namespace
}  // namespace photonloom
