// SPDX-License-Identifier: Apache-2.0
// Verilog to a library by Verilator.
#include <fmt/core.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <stdexcept>

#include "golden/numeric/output_file.hpp"
#include "golden/plan/units.hpp"
#include "verilator_tb/model/tools.hpp"

namespace photonloom::model_tools {

namespace fs = std::filesystem;

namespace {

// The C++ side of a library. Port storage is handed out as addresses, so nothing here depends on a
// width. @PORTS@ is a line a port. PHOTONLOOM_PLUSARGS of the environment, words such as +name=1,
// are those of the simulation. With coverage each counter's most in one run, by instance in the
// design, is written at the process's end into the folder PHOTONLOOM_COVERAGE: a bit that changed
// twice in one run went both ways, which a sum of runs would not show.
constexpr const char* kVerilatorShim = R"shim(// Generated.
#include "Vmodel.h"
#include "verilated.h"
#if VM_TRACE
#include "verilated_fst_c.h"
#endif
#if OPENED
#include "verilated_syms.h"
#endif
#include <cstdlib>
#include <sstream>
#include <string>
#include <vector>
#if VM_COVERAGE
#include <unistd.h>

#include "Vmodel___024root.h"
#include "Vmodel__Syms.h"
#include "verilated_cov.h"
#endif
namespace {
struct Port { const char* name; int output; void* data; unsigned long bytes; };
struct Memory { const char* name; const char* variable; void* data; unsigned long words, bits; };
struct Instance {
  VerilatedContext context;
  Vmodel* model = nullptr;
  Port ports[@COUNT@ + 1];
  std::vector<Memory> memories;
#if VM_TRACE
  VerilatedFstC* trace = nullptr;
#endif
#if VM_COVERAGE
  std::vector<uint32_t> in_reset;  // counts at the first reset's end, where counting starts anew
  bool resetting = false;
#endif
};
#if VM_COVERAGE
auto& counters(Instance* i) { return i->model->rootp->vlSymsp->__Vcoverage; }
// A bit that leaves its random initial value in reset has not been used; an arm has been reached.
void watch_reset(Instance* i, bool reset) {
  if (i->resetting && !reset && i->in_reset.empty())
    for (auto& count : counters(i)) i->in_reset.push_back(count.exchange(0));
  i->resetting = reset;
}
Instance* counted = nullptr;  // holds the most that each counter came to in one run
void write_coverage() {
  const char* folder = std::getenv("PHOTONLOOM_COVERAGE");
  if (!folder || !counted) return;
  counted->context.coveragep()->forcePerInstance(true);
  counted->context.coveragep()->write(
      (std::string(folder) + "/@NAME@-" + std::to_string(getpid()) + ".dat").c_str());
}
#endif
}
#define EXPORT extern "C" __attribute__((visibility("default")))
EXPORT void* model_create(int seed, int waveform) {
  Instance* i = new Instance;
  i->context.randReset(2);
  i->context.randSeed(seed);
  i->context.fatalOnError(false);
  if (const char* text = std::getenv("PHOTONLOOM_PLUSARGS")) {
    std::istringstream in(text);
    std::vector<std::string> words{"model"};
    for (std::string word; in >> word;) words.push_back(word);
    std::vector<const char*> arguments;
    for (const std::string& word : words) arguments.push_back(word.c_str());
    i->context.commandArgs(static_cast<int>(arguments.size()), arguments.data());
  }
#if VM_TRACE
  i->context.traceEverOn(waveform != 0);
#endif
  (void)waveform;
  i->model = new Vmodel(&i->context, "@UNIT@");
  Vmodel* m = i->model;
  unsigned n = 0;
@PORTS@
  i->ports[n] = Port{nullptr, 0, nullptr, 0};
#if OPENED
  for (const auto& scope : *i->context.scopeNameMap()) {
    if (!scope.second->varsp()) continue;
    for (const auto& entry : *scope.second->varsp()) {
      const VerilatedVar& v = entry.second;
      i->memories.push_back(Memory{scope.first, entry.first, v.datap(),
                                   static_cast<unsigned long>(v.udims() ? v.unpacked().elements() : 1),
                                   static_cast<unsigned long>(v.packed().elements())});
    }
  }
#endif
  i->memories.push_back(Memory{nullptr, nullptr, nullptr, 0, 0});
  return i;
}
EXPORT void model_destroy(void* p) {
  Instance* i = static_cast<Instance*>(p);
  i->model->final();
#if VM_COVERAGE
  auto& most = counters(i);
  for (size_t n = 0; n < i->in_reset.size(); ++n)
    if (most[n] == 0 && i->in_reset[n] > 0) most[n].store(1);
  if (counted) {
    const auto& before = counters(counted);
    for (size_t n = 0; n < sizeof most / sizeof most[0]; ++n)
      if (most[n] < before[n]) most[n].store(before[n]);
    delete counted->model;
    delete counted;
  } else {
    std::atexit(write_coverage);
  }
  counted = i;
#else
  delete i->model;
  delete i;
#endif
}
EXPORT const Port* model_ports(void* p) { return static_cast<Instance*>(p)->ports; }
EXPORT const Memory* model_memories(void* p) { return static_cast<Instance*>(p)->memories.data(); }
EXPORT int model_eval(void* p) {
  Instance* i = static_cast<Instance*>(p);
#if VM_COVERAGE
  watch_reset(i, @RESET@);
#endif
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
    "-std=gnu++17 -w -fPIC -fvisibility=hidden -faligned-new -DVERILATOR=1 "
    "-DVM_SC=0 -DVM_TRACE_VCD=0 -DVM_TIMING=0";

// -O2 takes nearly twice as long to compile a gatherer and runs a fifth faster: more than a million
// cycles have to follow before it pays.
constexpr const char* kModelOptimized = "-O1";

// What model_memories lists.
constexpr const char* kOpenMemories =
    "`verilator_config\n"
    "public_flat_rw -module \"block_ram\" -var \"memory\"\n"
    "public_flat_rw -module \"block_ram_two_reads\" -var \"memory\"\n";

// What Model::queues() lists: FIFOs, and the slots of the gatherer's results.
std::string open_queues() {
  std::string text = "`verilator_config\n";
  for (const std::string& module :
       {std::string("fifo"), unit_name<PhotonGatherer> + std::string("_results")})
    for (const char* pointer : {"head_q", "tail_q"})
      text += fmt::format("public_flat_rd -module \"{}\" -var \"{}\"\n", module, pointer);
  return text;
}

// Wider signals are not watched: bundles of others, and memories, which are at their ports.
constexpr const char* kVerilatorCoverage =
    " --coverage --coverage-underscore --coverage-max-width 256";

// Whether models count what of them was reached: PHOTONLOOM_COVERAGE of the environment.
bool with_coverage() { return std::getenv("PHOTONLOOM_COVERAGE") != nullptr; }

// The compiler's flags for all that depends on how the model was made.
std::string compile_flags(bool waveform) {
  return fmt::format("{0} -DVM_TRACE={1} -DVM_TRACE_FST={1} -DVM_COVERAGE={2}", kVerilatorCompile,
                     waveform ? 1 : 0, with_coverage() ? 1 : 0);
}

bool by_clang() { return compiler().version.find("clang") != std::string::npos; }

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

// A folder with Verilator's own runtime, runtime.a, and its headers, headers.hpp, which GCC finds
// precompiled beside them: to read them takes it more than a second for each model.
std::string build_runtime(const std::string& work, const std::vector<std::string>& classes,
                          bool waveform) {
  const Compiler& c = compiler();
  const std::string include = verilator().root + "/include";
  const std::string flags = compile_flags(waveform);
  std::string all = verilator().version + c.command + c.version + flags + kModelOptimized;
  for (const std::string& name : classes) all += ' ' + name;
  const std::string base = fmt::format("{}/runtime-{:016x}", work, text_hash(all, 2));
  const Lock lock(base + ".lock");
  if (fs::exists(base + "/runtime.a")) return base;
  OutputFolder folder(base);
  const std::string includes =
      fmt::format("-I{} -I{}", quoted(include), quoted(include + "/vltstd"));
  std::string headers = "// Generated.\n";
  for (const char* name : {"verilated.h", "verilated_syms.h"})
    headers += fmt::format("#include \"{}\"\n", name);
  if (waveform) headers += "#include \"verilated_fst_c.h\"\n";
  if (with_coverage()) headers += "#include \"verilated_cov.h\"\n";
  for (const char* name : {"cstdlib", "sstream", "string", "vector"})
    headers += fmt::format("#include <{}>\n", name);
  write_file(folder.temporary() + "/headers.hpp", headers);
  std::string objects, commands;
  for (const std::string& name : classes) {
    commands += fmt::format("{0} {1} -O2 {2} -c {3} -o {4}.o && ", c.command, flags, includes,
                            quoted(include + "/" + name + ".cpp"), name);
    objects += " " + name + ".o";
  }
  // Clang takes no precompiled header for an #include.
  const std::string precompile =
      by_clang() ? "true"
                 : fmt::format("{} {} {} {} -x c++-header headers.hpp -o headers.hpp.gch",
                               c.command, flags, kModelOptimized, includes);
  run_tool(fmt::format("cd {} && ( {} & h=$!; {} ar rcs runtime.a{}; r=$?; wait $h && exit $r )",
                       quoted(folder.temporary()), precompile, commands, objects),
           folder.temporary() + "/log", "compiling Verilator's runtime");
  folder.commit();
  return base;
}

}  // namespace

std::string verilator_version() { return verilator().version; }

std::string verilator_key() {
  return verilator().version + compiler().version + kVerilatorCompile + kModelOptimized +
         kVerilatorShim + (with_coverage() ? kVerilatorCoverage : "");
}

void verilate(const ModelInput& in, const std::vector<std::string>& files,
              const std::string& flags) {
  std::string list;
  for (const std::string& file : files) list += " " + file;
  run_tool(fmt::format("cd {} && verilator --cc -O3 {} --prefix Vmodel --Mdir obj --top-module "
                       "{}{}{}{}",
                       quoted(in.dir), flags, in.unit, in.waveform ? " --trace-fst" : "",
                       with_coverage() ? kVerilatorCoverage : "", list),
           in.dir + "/verilator.log",
           fmt::format("verilator on {} (build folder {})", in.unit, in.base));

  std::string ports;
  for (const ModulePort& p : in.ports)
    ports += fmt::format("  i->ports[n++] = Port{{\"{0}\", {1}, &m->{0}, sizeof(m->{0})}};\n",
                         p.name, p.output ? 1 : 0);
  std::string shim = replace_all(kVerilatorShim, "@PORTS@\n", ports);
  shim = replace_all(shim, "@COUNT@", fmt::format("{}", in.ports.size()));
  const bool resets = std::any_of(in.ports.begin(), in.ports.end(),
                                  [](const ModulePort& p) { return p.name == "rst_i"; });
  shim = replace_all(shim, "@RESET@", resets ? "i->model->rst_i" : "false");
  shim = fmt::format("#define OPENED {}\n", in.open_memories || in.open_queues ? 1 : 0) + shim;
  shim = replace_all(shim, "@NAME@", fs::path(in.base).filename().string());
  write_file(in.dir + "/obj/shim.cpp", replace_all(shim, "@UNIT@", in.unit));

  const std::string classes = read_file(in.dir + "/obj/Vmodel_classes.mk");
  // What runs once is not optimized. What is instantiated from templates is compiled at the end of
  // the file, as the rest.
  std::string all = "#include \"headers.hpp\"\n#include \"shim.cpp\"\n";
  const auto include = [&](std::initializer_list<const char*> variables) {
    for (const char* variable : variables)
      for (const std::string& name : make_list(classes, variable))
        all += fmt::format("#include \"{}.cpp\"\n", name);
  };
  include({"VM_CLASSES_FAST", "VM_SUPPORT_FAST"});
  all += "#pragma GCC push_options\n#pragma GCC optimize(\"O0\")\n#pragma clang optimize off\n";
  include({"VM_CLASSES_SLOW", "VM_SUPPORT_SLOW"});
  all += "#pragma clang optimize on\n#pragma GCC pop_options\n";
  write_file(in.dir + "/obj/all.cpp", all);
  // From there, so that a compiler's cache has it for every folder of models.
  const std::string runtime =
      fs::relative(build_runtime(in.work, make_list(classes, "VM_GLOBAL_FAST"), in.waveform),
                   in.dir + "/obj")
          .string();
  // Clang asks a function of GCC's library whether an atomic number has a lock.
  const std::string libraries =
      std::string(in.waveform ? "-lz " : "") + (by_clang() ? "-latomic" : "");
  run_tool(fmt::format("cd {0}/obj && {1} {2} {3} -I{4} -I. -I{5} -I{6} -c all.cpp -o all.o && "
                       "{1} -shared -o ../model.so all.o {4}/runtime.a -Wl,--exclude-libs,ALL "
                       "-pthread {7}",
                       quoted(in.dir), compiler().command, compile_flags(in.waveform),
                       kModelOptimized, quoted(runtime), quoted(verilator().root + "/include"),
                       quoted(verilator().root + "/include/vltstd"), libraries),
           in.dir + "/compile.log", fmt::format("compiling the model of {}", in.unit));
}

void build_verilator(const ModelInput& in) {
  std::string flags = "-Wall --assert --x-initial unique --x-assign unique";
  for (const std::string& p : in.parameters) flags += " " + quoted("-G" + p);
  std::vector<std::string> files = in.files;
  if (in.open_memories) {
    write_file(in.dir + "/open_memories.vlt", kOpenMemories);
    files.insert(files.begin(), "open_memories.vlt");
  }
  if (in.open_queues) {
    write_file(in.dir + "/open_queues.vlt", open_queues());
    files.insert(files.begin(), "open_queues.vlt");
  }
  verilate(in, files, flags);
}

}  // namespace photonloom::model_tools
