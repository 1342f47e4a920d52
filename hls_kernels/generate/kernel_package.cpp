// SPDX-License-Identifier: Apache-2.0
#include "hls_kernels/generate/kernel_package.hpp"

#include <fmt/core.h>

#include "golden/numeric/output_file.hpp"
#include "golden/packet/layout.hpp"
#include "golden/plan/plan_file.hpp"
#include "hls_kernels/generate/header.hpp"
#include "hls_kernels/generate/recording.hpp"
#include "hls_kernels/generate/schedule.hpp"
#include "rtl/generate/fill.hpp"

namespace photonloom {

namespace {

// Streams of a unit, a row each.
template <class Unit>
std::string stream_rows(const Plan& plan) {
  const auto row = [](const char* name, const char* way, const PacketLayout& layout) {
    return fmt::format("| `{}` | {} | `{}`, {} bits |\n", name, way, layout.name(), layout.bits());
  };
  std::string text = row("in", "in", PacketLayout::of<typename Unit::In>(plan));
  size_t n = 0;
  Unit::for_each_output([&](auto packet) {
    text +=
        row(Unit::kOutputs[n++], "out", PacketLayout::of<typename decltype(packet)::type>(plan));
  });
  return text;
}

std::string loop_rows(const std::vector<KernelLoop>& loops) {
  std::string text;
  for (const KernelLoop& loop : loops)
    for (const LoopDependency& d : loop.dependencies)
      text += fmt::format("| `{}` | {} | {} | {} | {} | {} |\n", loop.process, loop.interval(),
                          d.name, d.latency, d.distance, d.why);
  return text;
}

}  // namespace

std::map<std::string, std::string> write_kernel_package(const Plan& plan,
                                                        const std::string& hls_dir) {
  const std::string dir = hls_dir.empty() ? default_hls_dir() : hls_dir;
  const auto filled = [&](const std::string& name, const Places& places) {
    return fill(dir + "/package/" + name + ".in", places);
  };
  std::map<std::string, std::string> files;
  files["photonloom_hls.hpp"] = write_hls_header(plan, plan_hash(plan));
  std::string units, sections;
  for_each_unit([&](auto unit) {
    using Unit = typename decltype(unit)::type;
    const UnitInfo& info = unit_info<Unit>;
    if (!info.lacks(plan).empty()) return;
    const std::string name = info.name;
    units += (units.empty() ? "" : " ") + name;
    for (const std::string& file :
         hls_files(dir, {fmt::format("{0}/top.cpp", name), fmt::format("{0}/testbench.cpp", name)}))
      files["hls_kernels/" + file] = read_file(dir + "/" + file);
    files[fmt::format("data/{}.hpp", name)] = write_recording(unit, plan);
    const Places place = {{"UNIT", name}};
    files[fmt::format("vitis/{}/hls_config.cfg", name)] = filled("hls_config.cfg", place);
    files[fmt::format("vitis/{}/run.tcl", name)] = filled("vitis.tcl", place);
    files[fmt::format("catapult/{}.tcl", name)] = filled("catapult.tcl", place);
    files[fmt::format("bambu/{}.sh", name)] = filled("bambu.sh", place);
    sections += (sections.empty() ? "" : "\n") +
                filled("unit.md", {{"UNIT", name},
                                   {"STREAMS", stream_rows<Unit>(plan)},
                                   {"PORTS", read_file(dir + "/" + name + "/ports.md")},
                                   {"LOOPS", loop_rows(kernel_loops(unit, plan))}});
  });
  files["Makefile"] = filled("Makefile", {{"UNITS", units}});
  files["README.md"] = filled("README.md", {{"PLAN", plan_hash_text(plan)}, {"UNITS", sections}});
  return files;
}

}  // namespace photonloom
