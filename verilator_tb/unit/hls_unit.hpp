// SPDX-License-Identifier: Apache-2.0
// Units as HLS kernels, compiled natively per plan, behind golden/unit/backend.hpp. Their cycles
// are those that the kernels' loops count (docs/hls.md).
//
// RunOptions::seed and initial_seed choose the order in which a kernel's processes run, which must
// not matter, and what the stall policies of its streams do to its clock. The line memory has no
// latency but the kernel's own. A kernel that waits forever is a RigError, one that cannot be
// compiled a ModelBuildError.
#pragma once
#include <array>
#include <span>
#include <string>
#include <vector>

#include "golden/packet/layout.hpp"
#include "verilator_tb/rig/stall.hpp"
#include "verilator_tb/unit/backends.hpp"

namespace photonloom {

// One instance of a kernel's shared object.
class HlsKernel {
 public:
  HlsKernel(const Plan& plan, const std::string& unit, const RunOptions& options);
  // The library stays loaded: another instance may use it.
  ~HlsKernel() { destroy_(shell_); }
  HlsKernel(const HlsKernel&) = delete;
  HlsKernel& operator=(const HlsKernel&) = delete;

  template <class In>
  void run(const PacketLayout& layout, std::span<const In> in) {
    words_.resize(in.size() * layout.words());
    for (size_t i = 0; i < in.size(); ++i) layout.pack(&in[i], words_.data() + i * layout.words());
    const std::string problem = run_(shell_, words_.data(), in.size());
    if (!problem.empty()) throw RigError(unit_, ": " + problem);
  }
  void configure(uint32_t address, uint64_t data) { configure_(shell_, address, data); }
  void load_lines(int map, const std::vector<uint8_t>& bytes) {
    load_lines_(shell_, map, bytes.data(), bytes.size());
  }
  // Packets of the last run.
  template <class Out>
  void take(int stream, const PacketLayout& layout, std::vector<Out>& out) const {
    const uint32_t* words = nullptr;
    const uint64_t* cycles = nullptr;
    const size_t n = taken_(shell_, stream, &words, &cycles);
    for (size_t i = 0; i < n; ++i) {
      Out packet{};
      layout.unpack(words + i * layout.words(), &packet);
      out.push_back(packet);
    }
  }
  std::span<const uint64_t> out_cycles(int stream) const {
    const uint32_t* words = nullptr;
    const uint64_t* cycles = nullptr;
    const size_t n = taken_(shell_, stream, &words, &cycles);
    return {cycles, n};
  }
  std::span<const uint64_t> in_cycles() const {
    const uint64_t* cycles = nullptr;
    const size_t n = in_cycles_(shell_, &cycles);
    return {cycles, n};
  }
  uint64_t cycles() const { return cycles_(shell_); }
  // "turns of P" and "interval of P" for the loop of each process P.
  void count_loops(Counters& counters) const;
  // Of the kernel itself, without its streams.
  uint64_t state_bits() const { return state_bits_(); }

 private:
  template <class F>
  void symbol(F& f, const char* name) const;
  // Cycles for which the policy of a port holds back its next packet.
  static uint64_t gap(void* self, int port);

  std::string unit_;
  std::array<Stall, 3> stalls_;
  void* library_ = nullptr;
  void* shell_ = nullptr;
  void (*destroy_)(void*) = nullptr;
  const char* (*run_)(void*, const uint32_t*, size_t) = nullptr;
  void (*configure_)(void*, uint32_t, uint64_t) = nullptr;
  void (*load_lines_)(void*, int, const uint8_t*, size_t) = nullptr;
  size_t (*taken_)(void*, int, const uint32_t**, const uint64_t**) = nullptr;
  size_t (*in_cycles_)(void*, const uint64_t**) = nullptr;
  uint64_t (*cycles_)(void*) = nullptr;
  uint64_t (*state_bits_)() = nullptr;
  const char* (*loop_)(void*, size_t, unsigned*, uint64_t*) = nullptr;
  std::vector<uint32_t> words_;
};

// What all units share of Clocked. A run gives all that is due and no more can come after it, so
// finish() has nothing to wait for.
template <class Unit>
class HlsUnit : public ClockedUnit<Unit> {
 public:
  HlsUnit(const Plan& plan, const RunOptions& options)
      : plan_(plan), kernel_(plan, unit_name<Unit>, options) {}
  uint64_t cycles() const final { return kernel_.cycles(); }
  std::span<const uint64_t> in_cycles() const final { return kernel_.in_cycles(); }
  std::span<const uint64_t> out_cycles(int stream) const final {
    return kernel_.out_cycles(stream);
  }
  void finish() final {}
  Counters counters() const override {
    Counters all = {
        {"packets in", packets_}, {"cycles", cycles()}, {"bits of state", kernel_.state_bits()}};
    kernel_.count_loops(all);
    return all;
  }

 protected:
  Plan plan_;
  HlsKernel kernel_;
  uint64_t packets_ = 0;
};

// Of one stream in and one out.
template <class Unit>
class HlsStreamUnit final : public HlsUnit<Unit> {
 public:
  using In = typename Unit::In;
  using Out = typename Unit::FirstOut;

  HlsStreamUnit(const Plan& plan, const RunOptions& options)
      : HlsUnit<Unit>(plan, options),
        in_(PacketLayout::of<In>(plan)),
        out_(PacketLayout::of<Out>(plan)) {}

  void process(std::span<const In> in, std::vector<Out>& out) override {
    this->kernel_.run(in_, in);
    this->kernel_.take(0, out_, out);
    this->packets_ += in.size();
  }

 private:
  PacketLayout in_, out_;
};

}  // namespace photonloom
