// SPDX-License-Identifier: Apache-2.0
#include "verilator_tb/model.hpp"

#include <dlfcn.h>
#include <fcntl.h>
#include <fmt/core.h>
#include <sys/file.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <sstream>
#include <stdexcept>

#include "golden/numeric/output_file.hpp"
#include "golden/numeric/random.hpp"
#include "rtl/generate/package.hpp"
#include "rtl/generate/sources.hpp"

namespace photonloom {

namespace fs = std::filesystem;

namespace {

// The C++ side of a library. Port storage is handed out as addresses, so nothing here depends on a
// width. @PORTS@ is a line a port.
constexpr const char* kShim = R"shim(// Generated.
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
constexpr const char* kCompile =
    "-std=gnu++17 -w -fPIC -fvisibility=hidden -faligned-new -DVERILATOR=1 -DVM_COVERAGE=0 "
    "-DVM_SC=0 -DVM_TRACE_VCD=0 -DVM_TIMING=0";

std::string replace_all(std::string text, const std::string& what, const std::string& by) {
  for (size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += by.size())
    text.replace(at, what.size(), by);
  return text;
}

std::string quoted(const std::string& text) { return "'" + replace_all(text, "'", "'\\''") + "'"; }

// Output of a shell command; empty where it fails.
std::string output_of(const std::string& command) {
  std::string text;
  FILE* pipe = popen((command + " 2>/dev/null").c_str(), "r");
  if (!pipe) return text;
  std::array<char, 4096> buffer;
  for (size_t n; (n = fread(buffer.data(), 1, buffer.size(), pipe)) > 0;)
    text.append(buffer.data(), n);
  if (pclose(pipe) != 0) text.clear();
  while (!text.empty() && text.back() == '\n') text.pop_back();
  return text;
}

void run_tool(const std::string& command, const std::string& log, const std::string& what) {
  if (std::system(fmt::format("( {} ) >{} 2>&1", command, quoted(log)).c_str()) == 0) return;
  std::istringstream in(read_file(log));
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  std::string tail;
  for (size_t i = 0; i < lines.size() && i < 12; ++i) tail += "\n  " + lines[i];
  throw std::runtime_error(fmt::format("{} failed:{}", what, tail));
}

struct Tools {
  std::string compiler, verilator_version, verilator_root, compiler_version;
};

const Tools& tools() {
  static const Tools found = [] {
    Tools t;
    const char* cxx = std::getenv("CXX");
    t.compiler = cxx && *cxx ? cxx : "c++";
    t.compiler_version = output_of(t.compiler + " --version | head -n 1");
    if (t.compiler_version.empty())
      throw std::runtime_error(t.compiler + ": no C++ compiler found; set CXX");
    if (!output_of("command -v ccache").empty()) t.compiler = "ccache " + t.compiler;
    t.verilator_version = output_of("verilator --version");
    t.verilator_root = output_of("verilator --getenv VERILATOR_ROOT");
    if (t.verilator_version.empty() || t.verilator_root.empty())
      throw std::runtime_error(
          "verilator is not installed: it turns RTL into the model that runs here");
    return t;
  }();
  return found;
}

uint64_t text_hash(const std::string& text, uint64_t h) {
  for (const char c : text) h = (h ^ static_cast<unsigned char>(c)) * 0x100000001b3ull;
  return mix64(h ^ text.size());
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

// Only one process builds a thing; the others wait for it.
class Lock {
 public:
  explicit Lock(const std::string& path)
      : descriptor_(open(path.c_str(), O_CREAT | O_RDWR | O_CLOEXEC, 0644)) {
    if (descriptor_ < 0 || flock(descriptor_, LOCK_EX) != 0)
      throw std::runtime_error(fmt::format("{}: cannot be locked: {}", path, strerror(errno)));
  }
  ~Lock() { close(descriptor_); }
  Lock(const Lock&) = delete;
  Lock& operator=(const Lock&) = delete;

 private:
  int descriptor_;
};

// Verilator's own runtime, compiled once for all models.
std::string build_runtime(const std::string& work, const std::vector<std::string>& classes,
                          bool waveform) {
  const Tools& t = tools();
  std::string all = t.verilator_version + t.compiler + t.compiler_version + kCompile;
  for (const std::string& c : classes) all += ' ' + c;
  const std::string base =
      fmt::format("{}/runtime-{:016x}", work, text_hash(all, waveform ? 3 : 2));
  const Lock lock(base + ".lock");
  const std::string archive = base + "/runtime.a";
  if (fs::exists(archive)) return archive;
  OutputFolder folder(base);
  std::string objects, commands;
  for (const std::string& c : classes) {
    commands += fmt::format(
        "{0} {1} -O2 -DVM_TRACE={2} -DVM_TRACE_FST={2} -I{3} -I{4} -c {5} "
        "-o {6}.o && ",
        t.compiler, kCompile, waveform ? 1 : 0, quoted(t.verilator_root + "/include"),
        quoted(t.verilator_root + "/include/vltstd"),
        quoted(t.verilator_root + "/include/" + c + ".cpp"), c);
    objects += " " + c + ".o";
  }
  run_tool(
      fmt::format("cd {} && {} ar rcs runtime.a{}", quoted(folder.temporary()), commands, objects),
      folder.temporary() + "/log", "compiling Verilator's runtime");
  folder.commit();
  return archive;
}

}  // namespace

std::string build_model(const Plan& plan, const ModelSource& source) {
  const std::string rtl = source.rtl_dir.empty() ? default_rtl_dir() : source.rtl_dir;
  // A unit alone does not read PlanHash; without it plans that differ elsewhere share a model.
  const std::string package = write_package(plan, 0);
  const std::vector<std::string> files = module_files(rtl, source.unit);
  const Tools& t = tools();
  uint64_t key = text_hash(t.verilator_version + t.compiler_version + kCompile + kShim, 1);
  key = text_hash(package, key);
  for (const std::string& file : files) key = text_hash(read_file(rtl + "/" + file), key);
  key = text_hash(source.waveform ? "waveform" : "", key);
  std::string parameters;
  for (const std::string& p : source.parameters) parameters += " " + quoted("-G" + p);
  key = text_hash(parameters, key);

  std::error_code ignored;
  fs::create_directories(source.work_dir, ignored);
  if (!fs::is_directory(source.work_dir))
    throw std::runtime_error(source.work_dir + ": cannot be made, needed for Verilated models");
  const std::string work = fs::canonical(source.work_dir).string();
  const std::string base = fmt::format("{}/{}-{:016x}", work, source.unit, key);
  const std::string library = base + "/model.so";
  if (fs::exists(library)) return library;
  const Lock lock(base + ".lock");
  if (fs::exists(library)) return library;

  OutputFolder folder(base);
  const std::string dir = folder.temporary();
  write_file(dir + "/photonloom_pkg.sv", package);
  std::string list;
  for (const std::string& file : files) {
    const std::string name = fs::path(file).filename().string();
    write_file(dir + "/" + name, read_file(rtl + "/" + file));
    list += " " + name;
  }
  run_tool(fmt::format("cd {} && verilator --cc -Wall -O3 --assert --x-initial unique --x-assign "
                       "unique --prefix Vmodel --Mdir obj --top-module {}{}{} photonloom_pkg.sv{}",
                       quoted(dir), source.unit, parameters, source.waveform ? " --trace-fst" : "",
                       list),
           dir + "/verilator.log",
           fmt::format("verilator on {} (build folder {})", source.unit, base));

  std::string ports;
  const std::vector<ModulePort> module = module_ports(rtl, source.unit);
  for (const ModulePort& p : module)
    ports += fmt::format("  i->ports[n++] = Port{{\"{0}\", {1}, &m->{0}, sizeof(m->{0})}};\n",
                         p.name, p.output ? 1 : 0);
  std::string shim = replace_all(kShim, "@PORTS@\n", ports);
  shim = replace_all(shim, "@COUNT@", fmt::format("{}", module.size()));
  write_file(dir + "/obj/shim.cpp", replace_all(shim, "@UNIT@", source.unit));

  const std::string classes = read_file(dir + "/obj/Vmodel_classes.mk");
  std::string fast = "#include \"shim.cpp\"\n", slow;
  for (const char* variable : {"VM_CLASSES_FAST", "VM_SUPPORT_FAST"})
    for (const std::string& name : make_list(classes, variable))
      fast += fmt::format("#include \"{}.cpp\"\n", name);
  for (const char* variable : {"VM_CLASSES_SLOW", "VM_SUPPORT_SLOW"})
    for (const std::string& name : make_list(classes, variable))
      slow += fmt::format("#include \"{}.cpp\"\n", name);
  write_file(dir + "/obj/fast.cpp", fast);
  write_file(dir + "/obj/slow.cpp", slow);
  const std::string runtime =
      build_runtime(work, make_list(classes, "VM_GLOBAL_FAST"), source.waveform);
  const std::string compile =
      fmt::format("{0} {1} -DVM_TRACE={2} -DVM_TRACE_FST={2} -I. -I{3} -I{4}", t.compiler, kCompile,
                  source.waveform ? 1 : 0, quoted(t.verilator_root + "/include"),
                  quoted(t.verilator_root + "/include/vltstd"));
  run_tool(fmt::format("cd {0}/obj && ( {1} -O0 -c slow.cpp -o slow.o & s=$!; {1} -O2 -c fast.cpp "
                       "-o fast.o && wait $s ) && {1} -shared -o ../model.so fast.o slow.o {2} "
                       "-Wl,--exclude-libs,ALL -pthread {3}",
                       quoted(dir), compile, quoted(runtime), source.waveform ? "-lz" : ""),
           dir + "/compile.log", fmt::format("compiling the model of {}", source.unit));
  folder.commit();
  return library;
}

struct Model::Abi {
  struct Port {
    const char* name;
    int output;
    void* data;
    unsigned long bytes;
  };
  void* library = nullptr;
  void* instance = nullptr;
  void (*destroy)(void*) = nullptr;
  int (*eval)(void*) = nullptr;
  int (*trace_open)(void*, const char*) = nullptr;
  void (*trace_dump)(void*, unsigned long long) = nullptr;
  void (*trace_close)(void*) = nullptr;
  bool tracing = false;

  template <class F>
  void symbol(F& f, const char* name) const {
    f = reinterpret_cast<F>(dlsym(library, name));
    if (!f) throw std::runtime_error(fmt::format("model library: has no {}", name));
  }
};

Model::Model(const std::string& library, uint64_t initial_seed) : abi_(std::make_unique<Abi>()) {
  abi_->library = dlopen(library.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (!abi_->library) throw std::runtime_error(fmt::format("{}: {}", library, dlerror()));
  void* (*create)(int, int) = nullptr;
  const Abi::Port* (*ports)(void*) = nullptr;
  abi_->symbol(create, "model_create");
  abi_->symbol(ports, "model_ports");
  abi_->symbol(abi_->destroy, "model_destroy");
  abi_->symbol(abi_->eval, "model_eval");
  abi_->symbol(abi_->trace_open, "model_trace_open");
  abi_->symbol(abi_->trace_dump, "model_trace_dump");
  abi_->symbol(abi_->trace_close, "model_trace_close");
  // Verilator takes 31 bits, not 0.
  abi_->instance = create(static_cast<int>(mix64(initial_seed) % 0x7ffffffe) + 1, 1);
  for (const Abi::Port* p = ports(abi_->instance); p->name; ++p)
    ports_.push_back({p->name, p->output != 0, static_cast<uint8_t*>(p->data), p->bytes});
}

Model::~Model() {
  if (abi_->instance) {
    if (abi_->tracing) abi_->trace_close(abi_->instance);
    abi_->destroy(abi_->instance);
  }
  // The library stays loaded: another instance may use it, and loading is what costs.
}

const ModelPort& Model::port(const std::string& name) const {
  for (const ModelPort& p : ports_)
    if (p.name == name) return p;
  throw std::runtime_error(fmt::format("the model has no port {}", name));
}

bool Model::has_port(const std::string& name) const {
  for (const ModelPort& p : ports_)
    if (p.name == name) return true;
  return false;
}

void Model::eval() {
  if (abi_->eval(abi_->instance))
    throw std::runtime_error("the RTL stopped: an assertion failed (see above)");
}

void Model::open_waveform(const std::string& path) {
  if (abi_->trace_open(abi_->instance, path.c_str()) != 0)
    throw std::runtime_error(path + ": cannot be opened for writing a waveform");
  abi_->tracing = true;
}

void Model::dump(uint64_t time) { abi_->trace_dump(abi_->instance, time); }

void Model::close_waveform() {
  if (abi_->tracing) abi_->trace_close(abi_->instance);
  abi_->tracing = false;
}

}  // namespace photonloom
