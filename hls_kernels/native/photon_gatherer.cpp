// SPDX-License-Identifier: Apache-2.0
#include "hls_kernels/photon_gatherer/photon_gatherer.hpp"
#include "hls_kernels/native/shell.hpp"

namespace photonloom_hls {

namespace {

class GathererShell final : public Shell {
 public:
  GathererShell(uint64_t seed, const FarEnd& far_end)
      : Shell(seed, far_end), kernel_(std::make_unique<Kernel>()), nodes_(Kernel::kNodeWords) {
    for (int map = 0; map < 2; ++map) {
      maps_.lines[map] = 0;
      maps_.r2_max[map] = 0;
    }
  }

  // docs/photon_gatherer.md has the addresses.
  void configure(uint32_t address, uint64_t data) override {
    constexpr uint32_t kRegisters = 1u << 23;
    if (address < kRegisters)
      nodes_.at(address) = data;
    else if (address < kRegisters + 4 && address % 2 == 0)
      maps_.lines[(address - kRegisters) / 2] = data;
    else if (address < kRegisters + 4)
      maps_.r2_max[(address - kRegisters) / 2] = data;
  }

  void load_lines(int map, const uint8_t* bytes, size_t size) override {
    const size_t beat_bytes = kLineBeatBits / 8;
    const size_t first = map == 0 ? 0 : size_t{kGlobalMemoryLines} * Kernel::kBeats;
    const size_t beats = size / beat_bytes;
    if (lines_.size() < first + beats) lines_.resize(first + beats);
    for (size_t i = 0; i < beats; ++i)
      std::memcpy(lines_[first + i].words(), bytes + i * beat_bytes, beat_bytes);
  }

 private:
  using Kernel = PhotonGatherer<Native>;

  std::string simulate(const uint32_t* words, size_t packets) override {
    Stream<GatherQuery<Native>> in("in", kPortDepth);
    Stream<GatherResult<Native>> result("result", kPortDepth);
    Stream<GatherPhoton<Native>> photon("photon", kPortDepth);
    in.watch_reads(&in_cycles_);
    add_source(simulation_, in, far_end_, words, packets);
    simulation_.add("run", [&] {
      kernel_->run(in, result, photon, nodes_.data(), lines_.data(), maps_, packets);
    });
    add_taker(simulation_, result, far_end_, 1, taken_[0]);
    add_taker(simulation_, photon, far_end_, 2, taken_[1]);
    return simulation_.run();
  }

  std::unique_ptr<Kernel> kernel_;
  std::vector<Kernel::Node> nodes_;
  std::vector<Kernel::Beat> lines_;
  GatherMaps<Native> maps_;
};

}  // namespace

std::unique_ptr<Shell> make_shell(uint64_t seed, const FarEnd& far_end) {
  return std::make_unique<GathererShell>(seed, far_end);
}

}  // namespace photonloom_hls

PHOTONLOOM_HLS_INTERFACE(PhotonGatherer)
