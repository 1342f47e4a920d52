// SPDX-License-Identifier: Apache-2.0
// photonloom photons SCENE -o map.ply: traces one photon map into a file.
#include <fmt/core.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "command/command.hpp"
#include "command/console.hpp"
#include "command/frame_options.hpp"
#include "command/json_text.hpp"
#include "command/scene_option.hpp"
#include "golden/numeric/output_file.hpp"
#include "golden/scene/scene.hpp"
#include "golden/transport/world.hpp"
#include "golden/unit/photon_file.hpp"

namespace photonloom {
namespace {

struct PhotonsOptions {
  SceneOption scene;
  std::string output;
  bool caustic = false, json = false;
  uint64_t photons = 500000, seed = 1;
  ThreadsOption threads;
};

void photons(const PhotonsOptions& o) {
  require_suffix("--output", o.output, ".ply");
  check_outputs({o.output}, {o.scene.path()});
  o.threads.apply();
  ConsoleProgress progress;
  Scene read = o.scene.load();
  check_outputs({o.output}, read.files);
  World world(std::move(read));
  const auto caster = make_double_bvh(world);
  PhotonPass pass = o.caustic ? trace_caustic_photons(world, *caster, o.photons, o.seed, &progress)
                              : trace_global_photons(world, *caster, o.photons, o.seed, &progress);
  print_warnings(world.scene().warnings);
  if (pass.photons.empty())
    throw std::runtime_error(
        fmt::format("{}: no {} photon was stored after {} paths: {}", o.scene.path(),
                    o.caustic ? "caustic" : "global", pass.paths,
                    o.caustic && !world.has_delta() ? "the scene has no mirror and no glass"
                                                    : "no light reaches a diffuse surface"));
  if (pass.short_of_request)
    print_warnings({fmt::format("{} of {} photons stored after {} paths", pass.photons.size(),
                                o.photons, pass.paths)});
  const Scene& scene = world.scene();
  Rgb power(0);
  for (const Photon& photon : pass.photons) power += photon.power;
  PhotonFile file;
  file.photons = std::move(pass.photons);
  file.kind = o.caustic ? "caustic" : "global";
  file.scene = scene.name;
  file.scene_hash = scene.hash;
  file.seed = o.seed;
  file.paths = pass.paths;
  file.requested = o.photons;
  file.cube = Cube{world.cube_origin(), world.cube_extent()};
  write_photon_file(file, o.output);
  if (o.json) {
    nlohmann::ordered_json j;
    j["photons"] = file.photons.size();
    j["paths_emitted"] = pass.paths;
    j["power"] = {power.x, power.y, power.z};
    j["kind"] = file.kind;
    j["scene_hash"] = fmt::format("{:016x}", scene.hash);
    fmt::print("{}\n", json_text(j));
  } else {
    fmt::print("{}: {} {} photons of {} paths, {:.6g} {:.6g} {:.6g} W\n", o.output,
               file.photons.size(), file.kind, pass.paths, power.x, power.y, power.z);
  }
}

void add_photons(CLI::App& app) {
  auto o = std::make_shared<PhotonsOptions>();
  CLI::App* c = app.add_subcommand("photons", "Trace a photon map into a file");
  c->footer(
      "Writes a binary PLY with one vertex a photon: x y z in scene units; dx dy dz, the "
      "direction\n"
      "to where the light came from; power_r power_g power_b in W, already divided by the paths\n"
      "emitted; path, the number of the emitted path; bounce, the surfaces met before this one;\n"
      "flight, how far the light came from the last of them that is neither mirror nor glass. The\n"
      "comments name the scene, its hash, the seed, the paths emitted and the scene's cube.\n"
      "The global map has every photon that reaches a diffuse surface; the caustic map "
      "(--caustic)\n"
      "those that came from the light by mirrors and glass alone.\n\n"
      "Example: photonloom photons scenes/cornell_balls.xml -o global.ply\n"
      "         photonloom photons scenes/cornell_balls.xml --caustic -o caustic.ply\n"
      "         photonloom render scenes/cornell_balls.xml --load-photons global.ply\n"
      "                    --load-caustics caustic.ply -o out.exr");
  o->scene.add_to(*c);
  c->add_option("-o,--output", o->output, "PLY file to write")->required();
  c->add_flag("--caustic", o->caustic, "The caustic map instead of the global one");
  c->add_option("--photons", o->photons,
                "Photons to store; the path that fills the map is kept whole")
      ->check(CLI::Range(uint64_t{1}, uint64_t{1} << 30))
      ->capture_default_str()
      ->type_name("N");
  add_seed_option(*c, o->seed, "Seed; equal seeds give equal maps")->capture_default_str();
  c->add_flag("--json", o->json, "Print one JSON object");
  o->threads.add_to(*c);
  c->callback([o] { photons(*o); });
}

const Command photons_command(41, add_photons);

}  // namespace
}  // namespace photonloom
