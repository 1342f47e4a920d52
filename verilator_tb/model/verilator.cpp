// SPDX-License-Identifier: Apache-2.0
// Verilog to a library by Verilator.
#include <fmt/core.h>

#include <filesystem>
#include <sstream>
#include <stdexcept>

#include "golden/numeric/output_file.hpp"
#include "verilator_tb/model/tools.hpp"

namespace photonloom::model_tools {

namespace fs = std::filesystem;

namespace {

// The C++ side of a library. Port storage is handed out as addresses, so nothing here depends on a
// width. @PORTS@ is a line a port.
constexpr const char* kVerilatorShim = R"shim(// Generated.
#include "Vmodel.h"
#include "verilated.h"
#if VM_TRACE
#include "verilated_fst_c.h"
#endif
namespace {
struct Port { const char* name; int output; void* data; unsigned long bytes; };
struct Instance {
  VerilatedContext context;
  Vmodel* model = nullptr;
  Port ports[@COUNT@ + 1];
#if VM_TRACE
  VerilatedFstC* trace = nullptr;
#endif
};
}
#define EXPORT extern "C" __attribute__((visibility("default")))
EXPORT void* model_create(int seed, int waveform) {
  Instance* i = new Instance;
  i->context.randReset(2);
  i->context.randSeed(seed);
  i->context.fatalOnError(false);
#if VM_TRACE
  i->context.traceEverOn(waveform != 0);
#endif
  (void)waveform;
  i->model = new Vmodel(&i->context, "@UNIT@");
  Vmodel* m = i->model;
  unsigned n = 0;
@PORTS@
  i->ports[n] = Port{nullptr, 0, nullptr, 0};
  return i;
}
EXPORT void model_destroy(void* p) {
  Instance* i = static_cast<Instance*>(p);
  i->model->final();
  delete i->model;
  delete i;
}
EXPORT const Port* model_ports(void* p) { return static_cast<Instance*>(p)->ports; }
EXPORT int model_eval(void* p) {
  Instance* i = static_cast<Instance*>(p);
  i->model->eval();
  return i->context.gotFinish() ? 1 : 0;
}
EXPORT int model_trace_open(void* p, const char* path) {
#if VM_TRACE
  Instance* i = static_cast<Instance*>(p);
  i->trace = new VerilatedFstC;
  i->model->trace(i->trace, 99);
  i->trace->open(path);
  return i->trace->isOpen() ? 0 : 1;
#else
  (void)p; (void)path;
  return 1;
#endif
}
EXPORT void model_trace_dump(void* p, unsigned long long time) {
#if VM_TRACE
  static_cast<Instance*>(p)->trace->dump(static_cast<uint64_t>(time));
#else
  (void)p; (void)time;
#endif
}
EXPORT void model_trace_close(void* p) {
#if VM_TRACE
  Instance* i = static_cast<Instance*>(p);
  i->trace->close();
  delete i->trace;
  i->trace = nullptr;
#else
  (void)p;
#endif
}
)shim";

// The compiler's warnings are about generated code: all off.
constexpr const char* kVerilatorCompile =
    "-std=gnu++17 -w -fPIC -fvisibility=hidden -faligned-new -DVERILATOR=1 -DVM_COVERAGE=0 "
    "-DVM_SC=0 -DVM_TRACE_VCD=0 -DVM_TIMING=0";

struct Verilator {
  std::string version, root;
};

const Verilator& verilator() {
  static const Verilator found = [] {
    Verilator v{output_of("verilator --version"), output_of("verilator --getenv VERILATOR_ROOT")};
    if (v.version.empty() || v.root.empty())
      throw std::runtime_error(
          "verilator is not installed: it turns RTL into the model that runs here");
    return v;
  }();
  return found;
}

// Names in a variable of Verilator's list of classes.
std::vector<std::string> make_list(const std::string& text, const std::string& variable) {
  std::vector<std::string> names;
  size_t at = text.find(variable + " +=");
  if (at == std::string::npos) return names;
  at = text.find('=', at) + 1;
  std::istringstream in(text.substr(at, text.find("\n\n", at) - at));
  for (std::string word; in >> word;)
    if (word != "\\") names.push_back(word);
  return names;
}

// Verilator's own runtime, compiled once for all models.
std::string build_runtime(const std::string& work, const std::vector<std::string>& classes,
                          bool waveform) {
  const Compiler& c = compiler();
  const std::string include = verilator().root + "/include";
  std::string all = verilator().version + c.command + c.version + kVerilatorCompile;
  for (const std::string& name : classes) all += ' ' + name;
  const std::string base =
      fmt::format("{}/runtime-{:016x}", work, text_hash(all, waveform ? 3 : 2));
  const Lock lock(base + ".lock");
  const std::string archive = base + "/runtime.a";
  if (fs::exists(archive)) return archive;
  OutputFolder folder(base);
  std::string objects, commands;
  for (const std::string& name : classes) {
    commands += fmt::format(
        "{0} {1} -O2 -DVM_TRACE={2} -DVM_TRACE_FST={2} -I{3} -I{4} -c {5} "
        "-o {6}.o && ",
        c.command, kVerilatorCompile, waveform ? 1 : 0, quoted(include),
        quoted(include + "/vltstd"), quoted(include + "/" + name + ".cpp"), name);
    objects += " " + name + ".o";
  }
  run_tool(
      fmt::format("cd {} && {} ar rcs runtime.a{}", quoted(folder.temporary()), commands, objects),
      folder.temporary() + "/log", "compiling Verilator's runtime");
  folder.commit();
  return archive;
}

}  // namespace

std::string verilator_version() { return verilator().version; }

std::string verilator_key() {
  return verilator().version + compiler().version + kVerilatorCompile + kVerilatorShim;
}

void verilate(const ModelInput& in, const std::vector<std::string>& files, const std::string& flags,
              int optimise) {
  std::string list;
  for (const std::string& file : files) list += " " + file;
  run_tool(fmt::format("cd {} && verilator --cc -O3 {} --prefix Vmodel --Mdir obj --top-module "
                       "{}{}{}",
                       quoted(in.dir), flags, in.unit, in.waveform ? " --trace-fst" : "", list),
           in.dir + "/verilator.log",
           fmt::format("verilator on {} (build folder {})", in.unit, in.base));

  std::string ports;
  for (const ModulePort& p : in.ports)
    ports += fmt::format("  i->ports[n++] = Port{{\"{0}\", {1}, &m->{0}, sizeof(m->{0})}};\n",
                         p.name, p.output ? 1 : 0);
  std::string shim = replace_all(kVerilatorShim, "@PORTS@\n", ports);
  shim = replace_all(shim, "@COUNT@", fmt::format("{}", in.ports.size()));
  write_file(in.dir + "/obj/shim.cpp", replace_all(shim, "@UNIT@", in.unit));

  const std::string classes = read_file(in.dir + "/obj/Vmodel_classes.mk");
  std::string fast = "#include \"shim.cpp\"\n", slow;
  for (const char* variable : {"VM_CLASSES_FAST", "VM_SUPPORT_FAST"})
    for (const std::string& name : make_list(classes, variable))
      fast += fmt::format("#include \"{}.cpp\"\n", name);
  for (const char* variable : {"VM_CLASSES_SLOW", "VM_SUPPORT_SLOW"})
    for (const std::string& name : make_list(classes, variable))
      slow += fmt::format("#include \"{}.cpp\"\n", name);
  write_file(in.dir + "/obj/fast.cpp", fast);
  write_file(in.dir + "/obj/slow.cpp", slow);
  const std::string runtime =
      build_runtime(in.work, make_list(classes, "VM_GLOBAL_FAST"), in.waveform);
  const std::string compile =
      fmt::format("{0} {1} -DVM_TRACE={2} -DVM_TRACE_FST={2} -I. -I{3} -I{4}", compiler().command,
                  kVerilatorCompile, in.waveform ? 1 : 0, quoted(verilator().root + "/include"),
                  quoted(verilator().root + "/include/vltstd"));
  run_tool(
      fmt::format("cd {0}/obj && ( {1} -O0 -c slow.cpp -o slow.o & s=$!; {1} -O{4} -c fast.cpp "
                  "-o fast.o && wait $s ) && {1} -shared -o ../model.so fast.o slow.o {2} "
                  "-Wl,--exclude-libs,ALL -pthread {3}",
                  quoted(in.dir), compile, quoted(runtime), in.waveform ? "-lz" : "", optimise),
      in.dir + "/compile.log", fmt::format("compiling the model of {}", in.unit));
}

void build_verilator(const ModelInput& in) {
  std::string flags = "-Wall --assert --x-initial unique --x-assign unique";
  for (const std::string& p : in.parameters) flags += " " + quoted("-G" + p);
  verilate(in, in.files, flags, 2);
}

}  // namespace photonloom::model_tools
