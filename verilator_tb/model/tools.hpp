// SPDX-License-Identifier: Apache-2.0
// What the builders of model libraries share: running tools, hashing what goes in, one process at a
// time. Besides them (model.cpp, model_verilator, model_netlist, model_cxxrtl) only what quotes for
// a shell includes it.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "rtl/generate/sources.hpp"

namespace photonloom::model_tools {

std::string replace_all(std::string text, const std::string& what, const std::string& by);
// As one word of a shell.
std::string quoted(const std::string& text);
// Quoted only where a shell would take it for something else.
std::string shell_word(const std::string& text);
// Output of a shell command; empty where it fails.
std::string output_of(const std::string& command);
// The status of a shell command, as wait() gives it. Unlike system() it does not hide an interrupt:
// one that ended the command interrupts this program, and one of this program alone is not lost.
int run_shell(const std::string& command);
// Runs a shell command with its output in the file `log`; a failure is an error with the lines of
// the log that say why.
void run_tool(const std::string& command, const std::string& log, const std::string& what);
uint64_t text_hash(const std::string& text, uint64_t h);

struct Compiler {
  std::string command, version;  // $CXX or c++, behind ccache where that is installed
};
// An error where there is none.
const Compiler& compiler();

// Held while a thing of the work folder is built; the other processes wait for it.
class Lock {
 public:
  explicit Lock(const std::string& path);
  ~Lock();
  Lock(const Lock&) = delete;
  Lock& operator=(const Lock&) = delete;

 private:
  int descriptor_;
};

// What a builder turns into a library.
struct ModelInput {
  std::string unit;
  std::string dir;                 // where the sources lie and model.so is to be
  std::string base;                // the folder's name once it is complete, for messages
  std::string work;                // for what all models share
  std::vector<std::string> files;  // in dir, the package first
  std::vector<ModulePort> ports;
  std::vector<std::string> parameters;  // "Name=value"
  bool waveform = false;
  bool open_memories = false, open_queues = false;
  std::string yosys;    // the command
  std::string netlist;  // a netlist that is there already; empty: it is synthesized
};

struct Yosys {
  std::string version;  // "Yosys 0.23 (...)"
  std::string share;    // its folder of cell libraries and headers
};
// An error where `command` is no Yosys.
const Yosys& yosys(const std::string& command);
// Script lines that read the unit with its parameters.
std::string yosys_read(const ModelInput& in, const std::string& flags);

// A builder's key is everything beside unit, sources, parameters and waveform that its library
// depends on: tools and their versions, flags, text of its own. Asking for it is an error where a
// tool is missing.
std::string verilator_key();
std::string verilator_version();  // "Verilator 5.006 ..."
std::string netlist_key(const ModelInput& in);
std::string cxxrtl_key(const ModelInput& in);
void build_verilator(const ModelInput& in);
void build_netlist(const ModelInput& in);
void build_cxxrtl(const ModelInput& in);

// Verilog in `files`, in that order, to dir/model.so. `flags` are Verilator's.
void verilate(const ModelInput& in, const std::vector<std::string>& files,
              const std::string& flags);

}  // namespace photonloom::model_tools
