// SPDX-License-Identifier: Apache-2.0
// RTL to an ECP5 netlist by Yosys, and that to a library by Verilator.
#include <fmt/core.h>

#include "golden/numeric/output_file.hpp"
#include "rtl/generate/data_files.hpp"
#include "verilator_tb/model/tools.hpp"

namespace photonloom::model_tools {

namespace {

// Cells whose simulation models Yosys does not have. They come before Yosys' own file, where they
// stand as black boxes.
constexpr const char* kCells[] = {"DP16KD.sv", "MULT18X18D.sv"};

// What Yosys' models of the other cells consist of.
constexpr const char* kYosysCells[] = {"cells_sim.v", "cells_ff.vh", "cells_io.vh"};

// A register starts as the part's does. Warnings are about generated text: all off.
constexpr const char* kFlags = "--assert --x-initial 0 --x-assign 0 -Wno-fatal -Wno-lint";

std::string cells_dir() { return data_dir() + "/fpga/models"; }

}  // namespace

std::string netlist_key(const ModelInput& in) {
  std::string key = verilator_key() + kFlags;
  for (const char* cell : kCells) key += read_file(cells_dir() + "/" + cell);
  return key + yosys(in.yosys).version + (in.netlist.empty() ? "" : read_file(in.netlist));
}

void build_netlist(const ModelInput& in) {
  const std::string cells = yosys(in.yosys).share + "/ecp5/";
  if (in.netlist.empty()) {
    write_file(in.dir + "/netlist.ys",
               yosys_read(in, "") + fmt::format("synth_ecp5 -abc9 -top {}\n"
                                                "splitnets\nwrite_verilog -noattr netlist.v\n",
                                                in.unit));
    run_tool(fmt::format("cd {} && {} -q netlist.ys", quoted(in.dir), quoted(in.yosys)),
             in.dir + "/yosys.log", fmt::format("yosys on {} (build folder {})", in.unit, in.base));
  } else {
    write_file(in.dir + "/netlist.v", read_file(in.netlist));
  }
  std::vector<std::string> files;
  for (const char* cell : kCells) {
    write_file(in.dir + "/" + cell, read_file(cells_dir() + "/" + cell));
    files.push_back(cell);
  }
  for (const char* name : kYosysCells) write_file(in.dir + "/" + name, read_file(cells + name));
  files.insert(files.end(), {"cells_sim.v", "netlist.v"});
  verilate(in, files, kFlags);
}

}  // namespace photonloom::model_tools
