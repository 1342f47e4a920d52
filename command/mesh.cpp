// SPDX-License-Identifier: Apache-2.0
// photonloom mesh NAME -o FILE: the generated meshes and pictures of the scenes in scenes/.
#include <fmt/core.h>

#include "command/command.hpp"
#include "golden/scene/generate_mesh.hpp"
#include "golden/scene/generate_texture.hpp"

namespace photonloom {
namespace {

void add_mesh(CLI::App& app) {
  struct Options {
    std::string name, output;
    int triangles = 0;
  };
  auto o = std::make_shared<Options>();
  CLI::App* command =
      app.add_subcommand("mesh", "Write one of the meshes or pictures that scenes/ refers to");
  command->footer(
      "The build writes what scenes/*.xml name by default. Another size of the atrium:\n"
      "  photonloom mesh atrium --triangles 100000 -o scenes/meshes/atrium_100000.ply\n"
      "  photonloom info scenes/atrium.xml -D triangles=100000");
  command
      ->add_option("name", o->name,
                   "atrium: two-storey colonnade; ring: mirror ring; water: waves; planks, bricks: "
                   "textures; sky: environment")
      ->required()
      ->check(CLI::IsMember({"atrium", "ring", "water", "planks", "bricks", "sky"}));
  command
      ->add_option("--triangles", o->triangles,
                   "At most this many triangles of a mesh (default 20000; ring 2048; the atrium "
                   "has at least 2000)")
      ->check(CLI::Range(100, 10000000));
  command->add_option("-o,--output", o->output, "PLY, PNG or EXR file to write")->required();
  command->callback([o] {
    const bool mesh_asked = o->name == "atrium" || o->name == "ring" || o->name == "water";
    require_suffix("-o", o->output, mesh_asked ? ".ply" : o->name == "sky" ? ".exr" : ".png");
    if (!mesh_asked && o->triangles)
      throw UsageError(
          fmt::format("--triangles: {} is a picture, expected atrium, ring or water", o->name));
    const int triangles = o->triangles ? o->triangles : o->name == "ring" ? 2048 : 20000;
    Mesh mesh;
    using Write = void (*)(const std::string&);
    constexpr std::pair<const char*, Write> kPictures[] = {
        {"planks", write_planks}, {"bricks", write_bricks}, {"sky", write_sky}};
    for (const auto& [name, write] : kPictures)
      if (o->name == name) {
        write(o->output);
        fmt::print("wrote {}\n", o->output);
        return;
      }
    if (o->name == "atrium") {
      mesh = atrium_mesh(triangles);
    } else if (o->name == "ring") {
      mesh = ring_mesh(1.0, 1.06, 0.5, triangles / 8);
    } else {
      int cells = 1;
      while (2 * (cells + 1) * (cells + 1) <= triangles) ++cells;
      mesh = water_mesh(cells);
    }
    write_mesh(mesh, o->output);
    fmt::print("{}: {} triangles\n", o->output, mesh.triangles.size());
  });
}

const Command mesh_command(90, add_mesh);

}  // namespace
}  // namespace photonloom
