// SPDX-License-Identifier: Apache-2.0
// One unit under a clock, with its streams and its memory driven from C++.
//
// A cycle: inputs are set, the model settles with the clock low, handshakes are read, the clock
// rises. A stream is a port group NAME_valid, NAME_ready, NAME.
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "golden/plan/plan.hpp"
#include "verilator_tb/model/model.hpp"
#include "verilator_tb/rig/clocked.hpp"
#include "verilator_tb/rig/stall.hpp"

namespace photonloom {

// Faults that a rig injects, asked for by a test between packets and counted for it.
struct Faults {
  // Bits flipped in block RAM: `flips` of them, each at a cycle of the next `within`, in memories
  // whose names have one of these parts. A word that was flipped and not written since is left
  // alone.
  std::vector<std::string> memories;
  uint64_t flips = 0, within = 1;
  uint64_t flipped = 0;  // so far
  // Line port: of so many requests one, at random, is answered with an error and noise in one of
  // its beats; lines from these on are beyond memory, and all of such an answer is.
  uint64_t error_of = 0;
  std::array<uint64_t, 2> lines = {~0ull, ~0ull};
  uint64_t errors = 0;  // so far
};

// How a unit is run; none of it but `faults` may change a packet.
struct RunOptions {
  uint64_t seed = 1;          // of all stalls, latencies and initial register values
  uint64_t initial_seed = 1;  // mixed into the initial register values alone
  StallPolicy stall_in, stall_out, stall_memory;
  int latency = 20;             // of the line memory, cycles from request to first beat
  bool random_latency = false;  // uniform in [1, 2 * latency], replies out of order
  int banks = 8;                // of the line memory, by line number
  int bank_cycles = 0;          // a bank takes one request in so many cycles; 0: no limit
  uint64_t restart_after = 0;   // cycles from its first packet: reset, and all of it anew; 0: not
  uint64_t photon_pause = 0;    // so long nobody takes stream "photon", then a quarter of it
  std::optional<uint64_t> leaf_cache;  // a gatherer's word at 0x800004; none: as reset leaves it
  double sdram_period = 1;             // of a board's SDRAM clock, in cycles
  uint64_t watchdog = 500000;          // cycles without any handshake while something is owed
  std::string rtl_dir;                 // empty: default_rtl_dir()
  std::string work_dir = "build/cosim";
  ModelKind kind = ModelKind::kRtl;
  std::string yosys = "yosys";  // the command that makes netlists and CXXRTL models
  std::string netlist;          // of kNetlist: simulated instead of synthesizing one
  std::string waveform;         // file; empty: none
  uint64_t waveform_from = 0, waveform_to = ~0ull;  // cycles
  bool watch_queues = false;                        // count how full each queue of the RTL gets
  bool timeline = false;           // keep the cycle in which each packet went in and out
  std::shared_ptr<Faults> faults;  // none unless a test has some
};

// The unit is stuck, broke the rules of a stream, or failed an assertion of its own.
struct RigError : std::runtime_error {
  RigError(const std::string& unit_name, const std::string& what,
           std::optional<uint64_t> at_cycle = std::nullopt)
      : std::runtime_error("unit " + unit_name + what), unit(unit_name), cycle(at_cycle) {}
  std::string unit;
  std::optional<uint64_t> cycle;  // in which a waveform shows it
};

// Drives one input stream from a queue of packed packets. While it offers nothing the payload is
// random.
class Source {
 public:
  Source(Model& model, const std::string& name, int bits, const RunOptions& options,
         const std::string& unit);
  void push(const uint32_t* words);
  bool empty() const { return next_ * stride_ == queue_.size(); }
  uint64_t accepted() const { return accepted_; }
  uint64_t stalled() const { return stalled_; }  // cycles offered and not taken
  std::vector<uint64_t> take_cycles();           // of acceptance, since the last call
  std::string state() const;

  void drive();
  bool sample(uint64_t cycle);  // whether a packet was taken
  void after_edge();
  void restart();  // forgets what waits and what went in

 private:
  void scramble();
  std::string name_;
  const ModelPort &valid_, &ready_, &data_;
  Stall stall_;
  RoleRandom random_;
  bool timeline_;
  size_t stride_;
  std::vector<uint32_t> queue_, mask_;
  size_t next_ = 0;
  bool offering_ = false, was_ready_ = false;
  uint64_t accepted_ = 0, stalled_ = 0;
  std::vector<uint64_t> cycles_;
};

// Takes one output stream. Valid must stay and the payload must hold until taken.
class Taker {
 public:
  Taker(Model& model, const std::string& name, int bits, const RunOptions& options,
        const std::string& unit);
  const std::string& name() const { return name_; }
  uint64_t taken() const { return taken_; }      // since reset
  uint64_t stalled() const { return stalled_; }  // cycles offered and not taken
  size_t waiting() const { return cycles_.size() - first_; }
  // The oldest packet not yet popped.
  const uint32_t* front() const { return words_.data() + first_ * stride_; }
  uint64_t front_cycle() const { return cycles_[first_]; }
  void pop();
  std::string state() const;

  void drive();
  bool sample(uint64_t cycle);
  void restart();  // forgets what came

 private:
  std::string name_, unit_;
  const ModelPort &valid_, &ready_, &data_;
  Stall stall_;
  size_t stride_;
  std::vector<uint32_t> words_, held_;
  std::vector<uint64_t> cycles_;
  size_t first_ = 0;
  bool was_valid_ = false, holding_ = false;
  uint64_t pause_, driven_ = 0;
  uint64_t taken_ = 0, stalled_ = 0;
};

// The line memory behind a unit's line port: replies of whole lines, beats as wide as the port,
// lines never interleaved, one beat a cycle at most.
class LineMemory {
 public:
  LineMemory(Model& model, const Plan& plan, const RunOptions& options, const std::string& unit);
  // Line l of map m at byte l * line_bytes of lines[m]; must outlive the run.
  void load(const std::array<std::vector<uint8_t>, 2>& lines) { lines_ = &lines; }
  uint64_t requests() const { return requests_; }
  uint64_t bytes() const { return bytes_; }
  size_t outstanding() const { return pending_.size(); }
  std::string state() const;

  void drive(uint64_t cycle);
  bool sample(uint64_t cycle);  // whether a request or a beat went through
  void restart();               // what is not yet answered never will be

 private:
  struct Request {
    uint64_t ready_at;
    uint64_t tag;
    const uint8_t* data;
    size_t bad_from, bad_to;  // beats with an error
  };
  std::string unit_;
  const ModelPort &req_valid_, &req_ready_, &req_addr_, &req_tag_;
  const ModelPort &rsp_valid_, &rsp_tag_, &rsp_data_;
  Stall stall_req_, stall_rsp_;
  RoleRandom random_;
  int latency_;
  bool random_latency_;
  int bank_cycles_;
  int line_bits_;
  std::shared_ptr<Faults> faults_;
  size_t line_bytes_, beat_bytes_;
  const std::array<std::vector<uint8_t>, 2>* lines_ = nullptr;
  std::vector<Request> pending_;
  std::vector<uint64_t> bank_free_;
  std::vector<uint8_t> nothing_;  // a line that memory does not have
  size_t beat_ = 0;               // of the line being sent
  size_t sending_ = 0;            // its place in pending_
  bool in_line_ = false;          // a line is being sent
  bool beat_now_ = false, was_valid_ = false;
  uint64_t requests_ = 0, bytes_ = 0;
};

class Rig {
 public:
  // Builds or finds the model and resets it.
  Rig(const Plan& plan, const std::string& unit, const RunOptions& options);

  Source& add_source(const std::string& name, int bits);
  Taker& add_taker(const std::string& name, int bits);
  LineMemory& add_memory(const Plan& plan);

  void set(const std::string& port, uint64_t value);
  uint64_t get(const std::string& port) const;
  const ModelPort& port(const std::string& name) const { return model_.port(name); }
  bool has_port(const std::string& port) const { return model_.has_port(port); }
  std::vector<std::string> counter_ports() const;  // count_*_o

  // A second clock at port `name`, `period` of a cycle of clk_i, whose edges fall where they may.
  // `pins` is called before each of its rising edges, with the edge's number: it reads what that
  // domain drives and sets what it will see. One such clock at most.
  void add_clock(const std::string& name, double period, std::function<void(uint64_t)> pins);

  void reset();
  // Once, and where RunOptions::restart_after asks for it: has the unit given packets, clocks so
  // long from the first that goes in, then resets it and empties streams and memory. True where it
  // did.
  bool restart(const std::function<void()>& give);
  void cycle();
  // Clocks until done(); a RigError naming every stream's state when nothing moves for the
  // watchdog's cycles.
  void run_until(const std::function<bool()>& done);
  uint64_t cycles() const { return cycle_; }
  // Where RunOptions::watch_queues asks for it.
  const std::vector<QueueFill>& queue_fills() const { return queue_fills_; }

 private:
  std::string unit_;
  void flip_bits();
  void settle();                // the model; a failed assertion is a RigError
  std::string streams() const;  // the state of each, a line each

  RunOptions options_;
  Model model_;
  RoleRandom fault_random_;
  uint64_t flip_at_ = ~0ull;
  std::map<std::pair<size_t, size_t>, std::vector<uint8_t>> flipped_words_;  // memory, word
  std::vector<std::unique_ptr<Source>> sources_;
  std::vector<std::unique_ptr<Taker>> takers_;
  std::unique_ptr<LineMemory> memory_;
  uint8_t *clock_, *reset_;
  uint8_t* second_clock_ = nullptr;
  double second_period_ = 1;
  uint64_t second_edges_ = 0;
  std::function<void(uint64_t)> second_pins_;
  uint64_t cycle_ = 0;
  uint64_t quiet_ = 0;
  bool waveform_open_ = false;
  bool restarted_ = false;
  std::vector<QueueFill> queue_fills_;  // as model_.queues()
};

}  // namespace photonloom
