// SPDX-License-Identifier: Apache-2.0
// RTL to a library by Yosys' CXXRTL.
#include <fmt/core.h>

#include <filesystem>
#include <stdexcept>

#include "golden/numeric/output_file.hpp"
#include "verilator_tb/model/tools.hpp"

namespace photonloom::model_tools {

namespace fs = std::filesystem;

namespace {

// CXXRTL keeps every port in words of 32 bits and has types of its own for them; what is handed out
// are copies in the storage of ModelPort, carried over before and after the design settles. Its
// interface differs between versions where `debug` and the includes take turns. @INPUTS@, @OUTPUTS@
// and @PORTS@ are a line a port.
constexpr const char* kCxxrtlShim = R"shim(// Generated.
#include "design.cpp"
#include <cstdio>
#include <cstring>
#if MODEL_WAVEFORM
#if __has_include(<cxxrtl/cxxrtl_vcd.h>)
#include <cxxrtl/cxxrtl_vcd.h>
#else
#include <backends/cxxrtl/cxxrtl_vcd.h>
#endif
#endif
namespace {
template <size_t Bits>
struct Storage {
  static constexpr unsigned long bytes =
      Bits <= 8 ? 1 : Bits <= 16 ? 2 : 4 * ((Bits + 31) / 32);
  uint8_t data[(bytes + 7) / 8 * 8] = {};
};
template <size_t Bits> constexpr size_t bits_of(const cxxrtl::value<Bits>&) { return Bits; }
template <size_t Bits> constexpr size_t bits_of(const cxxrtl::wire<Bits>&) { return Bits; }
template <size_t Bits> void put(cxxrtl::value<Bits>& v, const Storage<Bits>& s) {
  std::memcpy(v.data, s.data, s.bytes);
}
template <size_t Bits> void put(cxxrtl::wire<Bits>& w, const Storage<Bits>& s) {
  std::memcpy(w.next.data, s.data, s.bytes);
}
template <size_t Bits> void get(const cxxrtl::value<Bits>& v, Storage<Bits>& s) {
  std::memcpy(s.data, v.data, s.bytes);
}
template <size_t Bits> void get(const cxxrtl::wire<Bits>& w, Storage<Bits>& s) {
  std::memcpy(s.data, w.curr.data, s.bytes);
}
using Design = cxxrtl_design::@DESIGN@;
template <class D>
auto debug(D& d, cxxrtl::debug_items& items, int) -> decltype(d.debug_info(items, std::string())) {
  d.debug_info(items, std::string());
}
template <class D>
auto debug(D& d, cxxrtl::debug_items& items, long)
    -> decltype(d.debug_info(&items, nullptr, std::string())) {
  d.debug_info(&items, nullptr, std::string());
}
struct Port { const char* name; int output; void* data; unsigned long bytes; };
struct Instance {
  Design design;
@STORAGE@
  Port ports[@COUNT@ + 1];
#if MODEL_WAVEFORM
  cxxrtl::vcd_writer writer;
  FILE* trace = nullptr;
#endif
};
// Registers begin with anything.
void scramble(Design& design, uint64_t seed) {
  cxxrtl::debug_items items;
  debug(design, items, 0);
  for (auto& entry : items.table)
    for (auto& item : entry.second) {
      if (item.type != cxxrtl::debug_item::WIRE || !item.next ||
          !(item.flags & cxxrtl::debug_item::DRIVEN_SYNC)) continue;
      for (size_t bit = 0; bit < item.width; bit += 32) {
        seed += 0x9e3779b97f4a7c15ull;
        uint64_t x = (seed ^ (seed >> 30)) * 0xbf58476d1ce4e5b9ull;
        x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
        uint32_t word = static_cast<uint32_t>(x >> 32);
        if (item.width - bit < 32) word &= (1u << (item.width - bit)) - 1;
        item.curr[bit / 32] = item.next[bit / 32] = word;
      }
    }
}
}
#define EXPORT extern "C" __attribute__((visibility("default")))
EXPORT void* model_create(int seed, int waveform) {
  (void)waveform;
  Instance* i = new Instance;
  scramble(i->design, static_cast<uint64_t>(seed));
  unsigned n = 0;
@PORTS@
  i->ports[n] = Port{nullptr, 0, nullptr, 0};
  return i;
}
EXPORT void model_destroy(void* p) { delete static_cast<Instance*>(p); }
EXPORT const Port* model_ports(void* p) { return static_cast<Instance*>(p)->ports; }
EXPORT int model_eval(void* p) {
  Instance* i = static_cast<Instance*>(p);
@INPUTS@
  i->design.step();
@OUTPUTS@
  return 0;
}
EXPORT int model_trace_open(void* p, const char* path) {
#if MODEL_WAVEFORM
  Instance* i = static_cast<Instance*>(p);
  i->trace = std::fopen(path, "wb");
  if (!i->trace) return 1;
  cxxrtl::debug_items items;
  debug(i->design, items, 0);
  i->writer.timescale(1, "ns");
  i->writer.add(items);
  return 0;
#else
  (void)p; (void)path;
  return 1;
#endif
}
EXPORT void model_trace_dump(void* p, unsigned long long time) {
#if MODEL_WAVEFORM
  Instance* i = static_cast<Instance*>(p);
  i->writer.sample(time);
  std::fwrite(i->writer.buffer.data(), 1, i->writer.buffer.size(), i->trace);
  i->writer.buffer.clear();
#else
  (void)p; (void)time;
#endif
}
EXPORT void model_trace_close(void* p) {
#if MODEL_WAVEFORM
  Instance* i = static_cast<Instance*>(p);
  std::fclose(i->trace);
  i->trace = nullptr;
#else
  (void)p;
#endif
}
)shim";

// Its own assertions would end the program where a memory is read beyond its end, which hardware
// may do where nobody looks at what comes; without them such a read gives 0.
constexpr const char* kCxxrtlCompile =
    "-DNDEBUG -std=gnu++17 -w -O2 -fPIC -fvisibility=hidden -shared";

// The C++ name of a Verilog name.
std::string mangled(const std::string& name) { return "p_" + replace_all(name, "_", "__"); }

}  // namespace

std::string cxxrtl_key(const ModelInput& in) {
  return yosys(in.yosys).version + compiler().version + kCxxrtlCompile + kCxxrtlShim;
}

void build_cxxrtl(const ModelInput& in) {
  const std::string include = yosys(in.yosys).share + "/include";
  if (!fs::is_directory(include))
    throw std::runtime_error(fmt::format(
        "{}: is not there, expected the CXXRTL headers of {} (Debian's package yosys-dev)", include,
        yosys(in.yosys).version));
  // RTL as it is simulated, not as it is synthesized: with the traps it sets for wrong uses.
  // Assertions are Verilator's.
  write_file(in.dir + "/cxxrtl.ys",
             yosys_read(in, "-nosynthesis") +
                 fmt::format("hierarchy -top {}\nchformal -remove\nwrite_cxxrtl -g{} design.cpp\n",
                             in.unit, in.waveform ? 4 : 1));
  run_tool(fmt::format("cd {} && {} -q cxxrtl.ys", quoted(in.dir), quoted(in.yosys)),
           in.dir + "/yosys.log", fmt::format("yosys on {} (build folder {})", in.unit, in.base));
  std::string storage, ports, inputs, outputs;
  for (const ModulePort& p : in.ports) {
    const std::string name = mangled(p.name);
    storage += fmt::format("  Storage<bits_of(decltype(Design::{0}){{}})> {0};\n", name);
    ports += fmt::format("  i->ports[n++] = Port{{\"{0}\", {1}, i->{2}.data, i->{2}.bytes}};\n",
                         p.name, p.output ? 1 : 0, name);
    (p.output ? outputs : inputs) +=
        fmt::format("  {0}(i->design.{1}, i->{1});\n", p.output ? "get" : "put", name);
  }
  std::string shim = replace_all(kCxxrtlShim, "@STORAGE@\n", storage);
  shim = replace_all(shim, "@PORTS@\n", ports);
  shim = replace_all(shim, "@INPUTS@\n", inputs);
  shim = replace_all(shim, "@OUTPUTS@\n", outputs);
  shim = replace_all(shim, "@COUNT@", fmt::format("{}", in.ports.size()));
  write_file(in.dir + "/shim.cpp", replace_all(shim, "@DESIGN@", mangled(in.unit)));
  run_tool(fmt::format("cd {} && {} {} -DMODEL_WAVEFORM={} -I. -I{} -I{} shim.cpp -o model.so",
                       quoted(in.dir), compiler().command, kCxxrtlCompile, in.waveform ? 1 : 0,
                       quoted(include), quoted(include + "/backends/cxxrtl/runtime")),
           in.dir + "/compile.log", fmt::format("compiling the CXXRTL model of {}", in.unit));
}

}  // namespace photonloom::model_tools
