// SPDX-License-Identifier: Apache-2.0
// photonloom generate PLAN -o DIR
#include <fmt/core.h>

#include <filesystem>

#include "golden/command/command.hpp"
#include "golden/numeric/output_file.hpp"
#include "rtl/generate/hardware.hpp"
#include "rtl/generate/sources.hpp"

namespace photonloom {
namespace {

struct GenerateOptions {
  std::string plan, output, unit, check, rtl;
};

void generate(const GenerateOptions& o) {
  const std::string rtl = o.rtl.empty() ? default_rtl_dir() : o.rtl;
  if (!o.check.empty()) {
    if (!o.plan.empty() || !o.output.empty() || !o.unit.empty())
      throw UsageError("--check DIR looks at a package alone; no other argument goes with it");
    check_hardware(o.check, rtl);
    fmt::print("{}: is what its plan and the RTL sources give\n", o.check);
    return;
  }
  if (o.plan.empty() || o.output.empty())
    throw UsageError("generate needs PLAN and -o DIR, or --check DIR");
  HardwareRequest request;
  request.plan = read_plan(o.plan);
  request.unit = o.unit;
  request.rtl_dir = rtl;
  const auto files = generate_hardware(request);
  OutputFolder folder(o.output);
  for (const auto& [name, text] : files) {
    const std::filesystem::path path = std::filesystem::path(folder.temporary()) / name;
    std::filesystem::create_directories(path.parent_path());
    write_file(path.string(), text);
  }
  folder.commit();
  fmt::print("wrote {}: {} files, plan {}\n", o.output, files.size(), plan_hash_text(request.plan));
}

void add_generate(CLI::App& app) {
  auto o = std::make_shared<GenerateOptions>();
  CLI::App* c = app.add_subcommand("generate", "A hardware package: RTL for one plan");
  c->footer(
      "The package holds the RTL that the plan uses, photonloom_pkg.sv with the plan's constants\n"
      "and packets, the wired top photonloom_chip, a file list, a FuseSoC core and a README with\n"
      "ports, packets and budget. Equal plans give equal packages.\n\n"
      "Examples:\n"
      "  photonloom plan scenes/cornell.xml -o plan.toml && photonloom generate plan.toml -o hw\n"
      "  photonloom generate plan.toml -o gatherer --unit photon_gatherer\n"
      "  photonloom generate --check hw");
  c->add_option("PLAN", o->plan, "The plan.toml");
  c->add_option("-o,--output", o->output, "Folder to write; an older package there is replaced")
      ->type_name("DIR");
  c->add_option("--unit", o->unit, "This unit alone, to be built into another system")
      ->type_name("NAME");
  c->add_option("--check", o->check, "Only tell whether the package in DIR is stale")
      ->type_name("DIR");
  c->add_option("--rtl", o->rtl, "Folder of the RTL sources, if not those of this build")
      ->type_name("DIR");
  c->callback([o] { generate(*o); });
}

const Command registered(40, add_generate);

}  // namespace
}  // namespace photonloom
