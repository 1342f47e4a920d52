// SPDX-License-Identifier: Apache-2.0
#include "verilator_tb/model/model.hpp"

#include <dlfcn.h>
#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <stdexcept>

#include "golden/numeric/output_file.hpp"
#include "golden/numeric/random.hpp"
#include "golden/plan/plan_file.hpp"
#include "rtl/generate/package.hpp"
#include "rtl/generate/sources.hpp"
#include "verilator_tb/model/tools.hpp"

namespace photonloom {

namespace fs = std::filesystem;

namespace {

using model_tools::ModelInput;

struct Builder {
  const char *name, *meaning;
  std::string (*key)(const ModelInput&);
  void (*build)(const ModelInput&);
  const char* waveform;
};

// In the order of ModelKind.
constexpr Builder kBuilders[] = {
    {"rtl", "the RTL in Verilator", [](const ModelInput&) { return model_tools::verilator_key(); },
     model_tools::build_verilator, "fst"},
    {"netlist", "its ECP5 netlist by Yosys, in Verilator", model_tools::netlist_key,
     model_tools::build_netlist, "fst"},
    {"cxxrtl", "the RTL as Yosys' CXXRTL makes C++ of it", model_tools::cxxrtl_key,
     model_tools::build_cxxrtl, "vcd"},
    {"hls", "its HLS kernel, compiled natively", nullptr, nullptr, ""},
};

}  // namespace

std::vector<std::string> model_kind_names() {
  std::vector<std::string> names;
  for (const Builder& b : kBuilders) names.push_back(b.name);
  return names;
}

std::string model_kinds_text() {
  std::string text;
  for (const Builder& b : kBuilders) text += (text.empty() ? "" : ", ") + std::string(b.name);
  return text;
}

std::optional<ModelKind> model_kind(const std::string& name) {
  for (size_t i = 0; i < std::size(kBuilders); ++i)
    if (name == kBuilders[i].name) return static_cast<ModelKind>(i);
  return std::nullopt;
}

std::string model_kind_name(ModelKind kind) { return kBuilders[static_cast<size_t>(kind)].name; }

std::string model_kind_meaning(ModelKind kind) {
  return kBuilders[static_cast<size_t>(kind)].meaning;
}

std::string waveform_extension(ModelKind kind) {
  return kBuilders[static_cast<size_t>(kind)].waveform;
}

namespace {

std::string find_or_build(const Plan& plan, const ModelSource& source) {
  using namespace model_tools;
  ModelInput in;
  const std::string rtl = source.rtl_dir.empty() ? default_rtl_dir() : source.rtl_dir;
  in.unit = source.unit;
  in.ports = module_ports(rtl, source.unit);
  in.parameters = source.parameters;
  in.waveform = source.waveform;
  in.open_memories = source.open_memories;
  in.open_queues = source.open_queues;
  if ((in.open_memories || in.open_queues) && source.kind != ModelKind::kRtl)
    throw std::runtime_error(
        fmt::format("a model of kind {} has no open {}, expected {}", model_kind_name(source.kind),
                    in.open_memories ? "memories" : "queues", model_kind_name(ModelKind::kRtl)));
  in.yosys = source.yosys;
  in.netlist = source.netlist;
  const Builder& builder = kBuilders[static_cast<size_t>(source.kind)];
  if (!builder.build)
    throw std::runtime_error(
        fmt::format("{} has no model of kind {}", source.unit, model_kind_name(source.kind)));
  const std::vector<std::string> files = module_files(rtl, source.unit);
  // A unit alone does not read PlanHash; without it plans that differ elsewhere share a model.
  const bool reads_hash = std::any_of(files.begin(), files.end(), [&](const std::string& file) {
    return read_file(rtl + "/" + file).find("photonloom_pkg::PlanHash") != std::string::npos;
  });
  const std::string package = write_package(plan, reads_hash ? plan_hash(plan) : 0);
  uint64_t key = text_hash(builder.key(in), 1);
  key = text_hash(package, key);
  for (const std::string& file : files) key = text_hash(read_file(rtl + "/" + file), key);
  key = text_hash(source.waveform ? "waveform" : "", key);
  if (source.open_memories) key = text_hash("open memories", key);
  if (source.open_queues) key = text_hash("open queues", key);
  for (const std::string& p : source.parameters) key = text_hash(p, key);

  std::error_code ignored;
  fs::create_directories(source.work_dir, ignored);
  if (!fs::is_directory(source.work_dir))
    throw std::runtime_error(source.work_dir + ": cannot be made, needed for models");
  in.work = fs::canonical(source.work_dir).string();
  in.base = fmt::format("{}/{}{}-{:016x}", in.work, source.unit,
                        source.kind == ModelKind::kRtl ? "" : std::string("-") + builder.name, key);
  const std::string library = in.base + "/model.so";
  if (fs::exists(library)) return library;
  const Lock lock(in.base + ".lock");
  if (fs::exists(library)) return library;

  OutputFolder folder(in.base);
  in.dir = folder.temporary();
  in.files = {"photonloom_pkg.sv"};
  write_file(in.dir + "/photonloom_pkg.sv", package);
  for (const std::string& file : files) {
    in.files.push_back(fs::path(file).filename().string());
    write_file(in.dir + "/" + in.files.back(), read_file(rtl + "/" + file));
  }
  builder.build(in);
  folder.commit();
  return library;
}

}  // namespace

std::string build_model(const Plan& plan, const ModelSource& source) {
  try {
    return find_or_build(plan, source);
  } catch (const std::exception& error) {
    throw ModelBuildError(error.what());
  }
}

struct Model::Abi {
  struct Port {
    const char* name;
    int output;
    void* data;
    unsigned long bytes;
  };
  struct Memory {
    const char *name, *variable;
    void* data;
    unsigned long words, bits;
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
  // Other kinds of libraries know of no memories.
  using Memories = const Abi::Memory* (*)(void*);
  const auto memories = reinterpret_cast<Memories>(dlsym(abi_->library, "model_memories"));
  for (const Abi::Memory* m = memories ? memories(abi_->instance) : nullptr; m && m->name; ++m) {
    const size_t bytes = (m->bits + 7) / 8;
    const size_t stride = bytes <= 2   ? bytes
                          : bytes <= 4 ? 4
                          : bytes <= 8 ? 8
                                       : (bytes + 3) / 4 * 4;
    const auto data = static_cast<uint8_t*>(m->data);
    const std::string variable = m->variable;
    if (variable == "memory") {
      memories_.push_back({m->name, data, m->words, m->bits, stride});
      continue;
    }
    auto queue = std::find_if(queues_.begin(), queues_.end(),
                              [&](const ModelQueue& q) { return q.name == m->name; });
    if (queue == queues_.end()) {
      queues_.push_back({m->name, nullptr, nullptr, size_t{1} << (m->bits - 1)});
      queue = queues_.end() - 1;
    }
    (variable == "head_q" ? queue->head : queue->tail) = data;
  }
  for (const ModelQueue& q : queues_)
    if (!q.head || !q.tail)
      throw std::runtime_error(
          fmt::format("model library: queue {} has no {}, expected both "
                      "head_q and tail_q",
                      q.name, q.head ? "tail_q" : "head_q"));
}

size_t ModelQueue::fill() const {
  const auto pointer = [&](const uint8_t* data) {
    size_t value = data[0];
    if (depth >= 256) value |= size_t{data[1]} << 8;
    return value;
  };
  return (pointer(tail) - pointer(head)) & (2 * depth - 1);
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
    throw ModelStopped("the RTL stopped: an assertion failed (see above)");
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
