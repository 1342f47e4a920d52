// SPDX-License-Identifier: Apache-2.0
// photonloom sheet: a contact sheet of images.
#include <fmt/core.h>

#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>

#include "command/command.hpp"
#include "golden/image/sheet.hpp"
#include "golden/numeric/output_file.hpp"

namespace photonloom {
namespace {

struct SheetOptions {
  std::vector<std::string> tiles;
  std::string output;
  int columns = 3, shrink = 1;
  std::optional<double> exposure;
};

// Where the label of LABEL=FILE ends; none where a file has the whole name.
size_t label_end(const std::string& tile) {
  return std::filesystem::exists(tile) ? std::string::npos : tile.find('=');
}

void sheet(const SheetOptions& o) {
  require_suffix("--output", o.output, ".png");
  std::vector<std::string> paths;
  for (const std::string& tile : o.tiles) {
    paths.push_back(tile.substr(label_end(tile) + 1));
    if (paths.back().empty())
      throw UsageError(fmt::format("TILE: '{}', expected LABEL=FILE or FILE", tile));
  }
  check_outputs({o.output}, paths);
  std::vector<Tile> tiles;
  double exposure = o.exposure.value_or(0);
  bool row_exposed = false;
  for (size_t i = 0; i < o.tiles.size(); ++i) {
    const size_t equals = label_end(o.tiles[i]);
    const std::string& path = paths[i];
    const std::string label = equals == std::string::npos
                                  ? std::filesystem::path(path).filename().string()
                                  : o.tiles[i].substr(0, equals);
    if (i % static_cast<size_t>(o.columns) == 0) row_exposed = false;
    if (std::filesystem::path(path).extension() == ".png") {
      tiles.push_back({read_png(path, o.shrink), label});
      continue;
    }
    const Image image = read_exr(path);
    if (!o.exposure && !row_exposed) {
      exposure = exposure_for(image, path);
      row_exposed = true;
    }
    tiles.push_back({picture_of(image, exposure, o.shrink, path), label});
  }
  const Picture p = contact_sheet(tiles, o.columns);
  write_png(p.rgb, p.width, p.height, o.output);
}

void add_sheet(CLI::App& app) {
  auto o = std::make_shared<SheetOptions>();
  CLI::App* c = app.add_subcommand("sheet", "A contact sheet (PNG) of EXR and PNG images");
  c->footer(
      "Without --exposure each row is exposed by its first EXR, so that 95 % of that image's\n"
      "pixels are below 0.8. A label ends at the first =, but for files whose names have one, and\n"
      "shows characters of ASCII, others as ?.\n\n"
      "Example: photonloom sheet -o sheet.png \"path traced=path.exr\" golden=golden.exr "
      "error.png");
  c->add_option("TILE", o->tiles, "LABEL=FILE or FILE, row by row; .exr or .png")->required();
  c->add_option("-o,--output", o->output, "The PNG to write")->required()->type_name("FILE.png");
  c->add_option("--columns", o->columns, "Tiles in a row (default 3)")->check(CLI::Range(1, 100));
  c->add_option("--shrink", o->shrink, "Average N x N pixels into one (default 1)")
      ->check(CLI::Range(1, 64))
      ->type_name("N");
  c->add_option("--exposure", o->exposure, "Show EXR values times 2^EV")
      ->check(number_range(-100, 100))
      ->type_name("EV");
  c->callback([o] { sheet(*o); });
}

const Command sheet_command(55, add_sheet);

}  // namespace
}  // namespace photonloom
