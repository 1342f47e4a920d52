// SPDX-License-Identifier: Apache-2.0
// A unit as a loadable library that simulates it: its RTL or its netlist by Verilator, or its RTL
// by CXXRTL. Built once per plan and source text, kept in a work folder by the hash of everything
// that went into it.
#pragma once
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "golden/plan/plan.hpp"

namespace photonloom {

// What a library simulates: the RTL by Verilator; the ECP5 netlist that Yosys makes of it, by
// Verilator with models of the part's cells (fpga/models and Yosys' own); the RTL by Yosys' CXXRTL.
// kHls is no model of the RTL but the unit's HLS kernel (model/hls.hpp).
enum class ModelKind { kRtl, kNetlist, kCxxrtl, kHls };

// Their names, in this order: "rtl", "netlist", "cxxrtl", "hls". What each is stands beside it in
// the list in model.cpp, of which messages and pages are made.
std::vector<std::string> model_kind_names();
std::string model_kinds_text();  // with commas between
std::optional<ModelKind> model_kind(const std::string& name);
std::string model_kind_name(ModelKind kind);
std::string model_kind_meaning(ModelKind kind);  // a phrase
// Of the waveforms it writes, "fst" or "vcd"; empty where it writes none.
std::string waveform_extension(ModelKind kind);

struct ModelSource {
  std::string unit;                      // module; of a generated package also photonloom_chip
  std::string rtl_dir;                   // empty: default_rtl_dir()
  std::string work_dir = "build/cosim";  // where libraries are kept
  bool waveform = false;                 // a library that can write waveforms; a little slower
  // Parameters of the module other than the plan's, "Name=value" each.
  std::vector<std::string> parameters = {};
  ModelKind kind = ModelKind::kRtl;
  std::string yosys = "yosys";  // the command, where one is needed
  // Of kNetlist: a Verilog netlist of the unit, instead of synthesizing one.
  std::string netlist = {};
  bool open_memories = false;  // of kRtl: block RAM can be read and written from outside
  bool open_queues = false;    // of kRtl: the fill of queues can be read
};

// A library cannot be made: what() says what is missing or what the tool said.
struct ModelBuildError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// Path of the library, built if it is not there (tens of seconds, a netlist minutes; needs a C++
// compiler, $CXX or c++, Verilator for all but CXXRTL, Yosys for all but the RTL). Several
// processes may ask for the same one. A failure is a ModelBuildError with the end of the tool's
// output.
std::string build_model(const Plan& plan, const ModelSource& source);

// The tools that make such a library, by name, and what each calls itself: compiler, verilator,
// yosys. An error where one is missing.
std::map<std::string, std::string> tool_versions(ModelKind kind, const std::string& yosys);

// A port's storage in the model: 1, 2, 4 or 8 bytes, or words of 32 bits least significant first.
struct ModelPort {
  std::string name;
  bool output = false;
  uint8_t* data = nullptr;
  size_t bytes = 0;
};

// A block RAM in the model: words one behind the other, each in 1, 2, 4 or 8 bytes, or in words of
// 32 bits least significant first.
struct ModelMemory {
  std::string name;  // instances in the design, from the top on, with dots between
  uint8_t* data = nullptr;
  size_t words = 0, bits = 0, stride = 0;  // bits of a word, bytes from one to the next
};

// A FIFO in the model, or the slots in which the gatherer's results wait: both count in pointers of
// one bit more than an address.
struct ModelQueue {
  std::string name;  // as of ModelMemory
  const uint8_t *head = nullptr, *tail = nullptr;
  size_t depth = 0;
  size_t fill() const;
};

// The RTL itself ended its run; what it had to say is on stdout.
struct ModelStopped : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// One instance of a loaded model, with its own initial register values.
class Model {
 public:
  Model(const std::string& library, uint64_t initial_seed);
  ~Model();
  Model(const Model&) = delete;
  Model& operator=(const Model&) = delete;

  const std::vector<ModelPort>& ports() const { return ports_; }
  // An unknown port is an error naming the unit.
  const ModelPort& port(const std::string& name) const;
  bool has_port(const std::string& name) const;
  // Its block RAMs, by name; of a model with open memories.
  const std::vector<ModelMemory>& memories() const { return memories_; }
  // Its queues, by name; of a model with open queues.
  const std::vector<ModelQueue>& queues() const { return queues_; }

  // Settles the model. A failed assertion or $fatal in the RTL throws ModelStopped.
  void eval();

  void open_waveform(const std::string& path);  // FST
  void dump(uint64_t time);
  void close_waveform();

 private:
  struct Abi;
  std::unique_ptr<Abi> abi_;
  std::vector<ModelPort> ports_;
  std::vector<ModelMemory> memories_;
  std::vector<ModelQueue> queues_;
};

}  // namespace photonloom
