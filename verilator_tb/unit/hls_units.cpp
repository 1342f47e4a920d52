// SPDX-License-Identifier: Apache-2.0
#include "verilator_tb/unit/hls_units.hpp"

#include <dlfcn.h>
#include <fmt/core.h>

#include <array>
#include <filesystem>

#include "golden/numeric/output_file.hpp"
#include "golden/numeric/random.hpp"
#include "golden/packet/layout.hpp"
#include "golden/unit/photon_gatherer_image.hpp"
#include "hls_kernels/generate/header.hpp"
#include "verilator_tb/model/tools.hpp"

namespace photonloom {

namespace {

namespace fs = std::filesystem;

// -fno-gnu-unique and hidden names: what is static in one plan's kernel is not that of another's.
const std::string& flags() {
  static const std::string text =
      std::string(
          "-std=c++17 -O2 -fPIC -shared -fvisibility=hidden -DPHOTONLOOM_HLS_NATIVE -Wall -Wextra "
          "-Werror") +
      (model_tools::compiler().version.find("clang") == std::string::npos ? " -fno-gnu-unique"
                                                                          : "");
  return text;
}

// Path of the unit's shared object for this plan, compiled where it is not there.
std::string find_or_build(const Plan& plan, const std::string& unit, const RunOptions& options) {
  using namespace model_tools;
  const std::string dir = default_hls_dir();
  const std::vector<std::string> files = hls_files(dir, unit);
  const std::string header = write_hls_header(plan, 0);  // plans that differ elsewhere share it
  uint64_t key = text_hash(compiler().version + flags() + header, 1);
  for (const std::string& file : files) key = text_hash(read_file(dir + "/" + file), key);

  std::error_code ignored;
  fs::create_directories(options.work_dir, ignored);
  if (!fs::is_directory(options.work_dir))
    throw std::runtime_error(options.work_dir + ": cannot be made, needed for models");
  const std::string base =
      fmt::format("{}/{}-hls-{:016x}", fs::canonical(options.work_dir).string(), unit, key);
  const std::string library = base + "/model.so";
  if (fs::exists(library)) return library;
  const Lock lock(base + ".lock");
  if (fs::exists(library)) return library;

  OutputFolder folder(base);
  const std::string& to = folder.temporary();
  write_file(to + "/photonloom_hls.hpp", header);
  for (const std::string& file : files) {
    const fs::path path = to + "/hls_kernels/" + file;
    fs::create_directories(path.parent_path());
    write_file(path.string(), read_file(dir + "/" + file));
  }
  run_tool(fmt::format("cd {0} && {1} {2} -I. hls_kernels/{3} -o model.so", quoted(to),
                       compiler().command, flags(), files[0]),
           to + "/compile.log", fmt::format("compiling the HLS kernel {}", unit));
  folder.commit();
  return library;
}

std::string build_kernel(const Plan& plan, const std::string& unit, const RunOptions& options) {
  try {
    return find_or_build(plan, unit, options);
  } catch (const std::exception& error) {
    throw ModelBuildError(error.what());
  }
}

// One instance of a kernel's shared object.
class Kernel {
 public:
  Kernel(const Plan& plan, const std::string& unit, const RunOptions& options)
      : unit_(unit),
        stalls_{Stall(options.stall_in, options.seed, unit + "/in"),
                Stall(options.stall_out, options.seed, unit + "/out"),
                Stall(options.stall_out, options.seed, unit + "/photon")} {
    if (!options.waveform.empty())
      throw ModelBuildError(fmt::format("{}: an HLS kernel writes no waveform", unit));
    const std::string path = build_kernel(plan, unit, options);
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
    shell_ = create(mix64(options.seed ^ mix64(options.initial_seed)), gap, this);
  }
  // The library stays loaded: another instance may use it.
  ~Kernel() { destroy_(shell_); }
  Kernel(const Kernel&) = delete;
  Kernel& operator=(const Kernel&) = delete;

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

 private:
  template <class F>
  void symbol(F& f, const char* name) const {
    f = reinterpret_cast<F>(dlsym(library_, name));
    if (!f) throw std::runtime_error(fmt::format("HLS kernel {}: has no {}", unit_, name));
  }

  // Cycles for which the policy of a port holds back its next packet.
  static uint64_t gap(void* self, int port) {
    Stall& stall = static_cast<Kernel*>(self)->stalls_[static_cast<size_t>(port)];
    uint64_t cycles = 0;
    while (port == 0 ? stall.holds_source(true) : stall.holds_taker(true)) ++cycles;
    return cycles;
  }

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
  std::vector<uint32_t> words_;
};

// What all units share of Clocked. A run gives all that is due and no more can come after it, so
// finish() has nothing to wait for.
template <class Base>
class HlsUnit : public Base {
 public:
  HlsUnit(const Plan& plan, const std::string& unit, const RunOptions& options)
      : plan_(plan), kernel_(plan, unit, options) {}
  uint64_t cycles() const final { return kernel_.cycles(); }
  std::span<const uint64_t> in_cycles() const final { return kernel_.in_cycles(); }
  std::span<const uint64_t> out_cycles(int stream) const final {
    return kernel_.out_cycles(stream);
  }
  void finish() final {}
  Counters counters() const override { return {{"packets in", packets_}, {"cycles", cycles()}}; }

 protected:
  Plan plan_;
  Kernel kernel_;
  uint64_t packets_ = 0;
};

template <class Base, class In, class Out>
class HlsStreamUnit final : public HlsUnit<Base> {
 public:
  HlsStreamUnit(const Plan& plan, const std::string& unit, const RunOptions& options)
      : HlsUnit<Base>(plan, unit, options),
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

class HlsPhotonGatherer final : public HlsUnit<ClockedPhotonGatherer> {
 public:
  HlsPhotonGatherer(const Plan& plan, const RunOptions& options)
      : HlsUnit(plan, "photon_gatherer", options),
        query_(PacketLayout::of<GatherQuery>(plan)),
        result_(PacketLayout::of<GatherResult>(plan)),
        photon_(PacketLayout::of<GatherPhoton>(plan)) {}

  void load(const PhotonMap& global, const PhotonMap& caustic) override {
    const PhotonGathererImage image = photon_gatherer_image(plan_, global, caustic);
    for (const CfgWrite& w : image.cfg) kernel_.configure(w.address, w.data);
    for (const int map : {0, 1}) kernel_.load_lines(map, image.lines[static_cast<size_t>(map)]);
  }
  void process(std::span<const GatherQuery> in, std::vector<GatherResult>& results,
               std::vector<GatherPhoton>& photons) override {
    kernel_.run(query_, in);
    const size_t first = results.size();
    kernel_.take(0, result_, results);
    kernel_.take(1, photon_, photons);
    packets_ += in.size();
    for (size_t i = first; i < results.size(); ++i) {
      nodes_ += results[i].nodes;
      leaves_ += results[i].leaves;
      insertions_ += results[i].insertions;
    }
  }
  Counters counters() const override {
    Counters c = HlsUnit::counters();
    c["nodes"] = nodes_;
    c["leaves"] = leaves_;
    c["insertions"] = insertions_;
    c["bytes read"] = leaves_ * static_cast<uint64_t>(plan_.line_bytes());
    return c;
  }

 private:
  PacketLayout query_, result_, photon_;
  uint64_t nodes_ = 0, leaves_ = 0, insertions_ = 0;  // of all results
};

}  // namespace

std::unique_ptr<ClockedPhotonGatherer> make_hls_photon_gatherer(const Plan& plan,
                                                                const RunOptions& options) {
  return std::make_unique<HlsPhotonGatherer>(plan, options);
}

std::unique_ptr<ClockedReorderBuffer> make_hls_reorder_buffer(const Plan& plan,
                                                              const RunOptions& options) {
  return std::make_unique<HlsStreamUnit<ClockedReorderBuffer, GatherQuery, GatherQuery>>(
      plan, "reorder_buffer", options);
}

std::unique_ptr<ClockedCdfSampler> make_hls_cdf_sampler(const Plan& plan,
                                                        const RunOptions& options) {
  return std::make_unique<HlsStreamUnit<ClockedCdfSampler, SamplerInput, Sample>>(
      plan, "cdf_sampler", options);
}

}  // namespace photonloom
