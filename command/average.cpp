// SPDX-License-Identifier: Apache-2.0
// photonloom average: the mean of images, channel by channel.
#include <fmt/core.h>

#include <algorithm>
#include <memory>
#include <set>
#include <stdexcept>

#include "command/command.hpp"
#include "golden/image/image.hpp"
#include "golden/numeric/output_file.hpp"

namespace photonloom {
namespace {

struct AverageOptions {
  std::vector<std::string> inputs, channels;
  std::string output;
};

// The channel of that name; `path` is for the error.
const Channel& channel_of(const Image& image, const std::string& name, const std::string& path) {
  const Channel* c = image.find(name);
  if (!c) throw std::runtime_error(fmt::format("{}: there is no channel {}", path, name));
  return *c;
}

void average(const AverageOptions& o) {
  require_suffix("--output", o.output, ".exr");
  if (std::set<std::string>(o.channels.begin(), o.channels.end()).size() != o.channels.size())
    throw UsageError("--channels: a name stands twice");
  check_outputs({o.output}, o.inputs);
  std::vector<Image> images;
  for (const std::string& path : o.inputs) {
    images.push_back(read_exr(path));
    if (images.back().width != images[0].width || images.back().height != images[0].height)
      throw std::runtime_error(fmt::format("{}: {}x{} pixels, expected {}x{} like {}", path,
                                           images.back().width, images.back().height,
                                           images[0].width, images[0].height, o.inputs[0]));
  }
  Image mean;
  mean.width = images[0].width;
  mean.height = images[0].height;
  mean.metadata = images[0].metadata;
  mean.metadata["averaged"] = std::to_string(images.size()) + " images";
  std::vector<std::string> names = o.channels;
  if (names.empty())
    for (const Channel& c : images[0].channels) names.push_back(c.name);
  for (const std::string& name : names) {
    Channel& out = mean.add(name);
    for (size_t pixel = 0; pixel < out.pixels.size(); ++pixel) {
      double sum = 0;
      for (size_t i = 0; i < images.size(); ++i)
        sum += static_cast<double>(channel_of(images[i], name, o.inputs[i]).pixels[pixel]);
      out.pixels[pixel] = static_cast<float>(sum / static_cast<double>(images.size()));
    }
  }
  write_exr(mean, o.output);
}

void add_average(CLI::App& app) {
  auto o = std::make_shared<AverageOptions>();
  CLI::App* c = app.add_subcommand("average", "The mean of images, channel by channel");
  c->footer(
      "All images have the same size; metadata are the first one's, and `averaged`, how many "
      "there\n"
      "are. Renders with different seeds average to one with as many samples as all of them.\n\n"
      "Example: photonloom average seed1.exr seed2.exr -o both.exr --channels R,G,B");
  c->add_option("IMAGE", o->inputs, "EXR files")->required();
  c->add_option("-o,--output", o->output, "The EXR to write")->required()->type_name("FILE.exr");
  c->add_option("--channels", o->channels, "Keep only these (default: those of the first image)")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->type_name("NAME,...");
  c->callback([o] { average(*o); });
}

const Command average_command(56, add_average);

}  // namespace
}  // namespace photonloom
