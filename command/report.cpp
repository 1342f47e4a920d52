// SPDX-License-Identifier: Apache-2.0
// photonloom report RUN|STUDY -o report.html: one page that needs nothing else.
#include "report/report.hpp"

#include <fmt/core.h>

#include <filesystem>
#include <memory>

#include "command/command.hpp"
#include "command/console.hpp"
#include "golden/numeric/output_file.hpp"

namespace photonloom {
namespace {

struct ReportOptions {
  std::vector<std::string> folders, images;
  std::string output;
};

// From SCENE/LABEL=FILE.
ExtraImage extra_image(const std::string& text) {
  const size_t equals = text.find('='), slash = text.find('/');
  if (slash == std::string::npos || equals == std::string::npos || slash > equals || slash == 0 ||
      equals == slash + 1 || equals + 1 == text.size())
    throw UsageError(fmt::format("--image: '{}', expected SCENE/LABEL=FILE.exr", text));
  return {text.substr(0, slash), text.substr(slash + 1, equals - slash - 1),
          text.substr(equals + 1)};
}

void report(const ReportOptions& o) {
  require_suffix("-o", o.output, ".html");
  check_outputs({o.output}, {});
  ConsoleProgress progress;
  ReportRequest request;
  request.folders = o.folders;
  for (const std::string& text : o.images) request.images.push_back(extra_image(text));
  request.program = PHOTONLOOM_VERSION;
  request.progress = &progress;
  const std::string page = report_page(request);
  write_file(o.output, page);
  fmt::print("wrote {}: {:.2f} MB, opens in a browser without a network\n", o.output,
             static_cast<double>(page.size()) / 1e6);
}

void add_report(CLI::App& app) {
  auto o = std::make_shared<ReportOptions>();
  CLI::App* c = app.add_subcommand("report", "A run or a study as one self-contained page");
  c->footer(
      "Shows images with their layers and errors, the plan with its reasons, packets, units over\n"
      "time and resources of a run (what cosim wrote), and error against cost of a study (what\n"
      "sweep wrote). Several folders make one page; the plan of a run is marked among the points\n"
      "of a study. docs/report.md describes the page and its keys.\n\n"
      "Examples:\n"
      "  photonloom cosim scenes/cornell.xml --size 64x64 -o run\n"
      "  photonloom report run -o report.html\n"
      "  photonloom report build/tradeoffs run -o report.html \\\n"
      "      --image cornell_balls/path-traced=scenes/references/cornell_balls.exr");
  c->add_option("FOLDER", o->folders, "Folders of cosim and sweep")
      ->required()
      ->type_name("RUN|STUDY...");
  c->add_option("-o,--output", o->output, "The page")->required()->type_name("OUT.html");
  c->add_option("--image", o->images,
                "A further image of a run's or study's scene; the first is what errors refer to")
      ->type_name("SCENE/LABEL=FILE.exr")
      ->take_all();
  c->callback([o] { report(*o); });
}

const Command report_command(48, add_report);

}  // namespace
}  // namespace photonloom
