// SPDX-License-Identifier: Apache-2.0
#include "verilator_tb/unit/hls_unit.hpp"

#include <dlfcn.h>
#include <fmt/core.h>

#include <stdexcept>

#include "golden/numeric/random.hpp"
#include "verilator_tb/model/hls.hpp"

namespace photonloom {

template <class F>
void HlsKernel::symbol(F& f, const char* name) const {
  f = reinterpret_cast<F>(dlsym(library_, name));
  if (!f) throw std::runtime_error(fmt::format("HLS kernel {}: has no {}", unit_, name));
}

HlsKernel::HlsKernel(const Plan& plan, const std::string& unit, const RunOptions& options)
    : unit_(unit),
      stalls_{Stall(options.stall_in, options.seed, unit + "/in"),
              Stall(options.stall_out, options.seed, unit + "/out"),
              Stall(options.stall_out, options.seed, unit + "/photon")} {
  if (!options.waveform.empty())
    throw ModelBuildError(fmt::format("{}: an HLS kernel writes no waveform", unit));
  const std::string path = build_kernel(plan, unit, options.work_dir);
  library_ = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (!library_) throw std::runtime_error(fmt::format("{}: {}", path, dlerror()));
  void* (*create)(uint64_t, uint64_t(*)(void*, int), void*) = nullptr;
  symbol(create, "kernel_create");
  symbol(destroy_, "kernel_destroy");
  symbol(run_, "kernel_run");
  symbol(configure_, "kernel_configure");
  symbol(load_lines_, "kernel_load_lines");
  symbol(taken_, "kernel_taken");
  symbol(in_cycles_, "kernel_in_cycles");
  symbol(cycles_, "kernel_cycles");
  symbol(state_bits_, "kernel_state_bits");
  symbol(loop_, "kernel_loop");
  shell_ = create(mix64(options.seed ^ mix64(options.initial_seed)), gap, this);
}

void HlsKernel::count_loops(Counters& counters) const {
  unsigned interval = 0;
  uint64_t turns = 0;
  for (size_t i = 0; const char* process = loop_(shell_, i, &interval, &turns); ++i) {
    counters[fmt::format("turns of {}", process)] = turns;
    counters[fmt::format("interval of {}", process)] = interval;
  }
}

uint64_t HlsKernel::gap(void* self, int port) {
  Stall& stall = static_cast<HlsKernel*>(self)->stalls_[static_cast<size_t>(port)];
  uint64_t cycles = 0;
  while (port == 0 ? stall.holds_source(true) : stall.holds_taker(true)) ++cycles;
  return cycles;
}

}  // namespace photonloom
