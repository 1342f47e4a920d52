// SPDX-License-Identifier: Apache-2.0
// A kernel as a shared object: packed packets in and out by a C interface, around a native run.
// What loads it is verilator_tb/unit/hls_unit.cpp.
#pragma once
#include <cstdint>
#include <cstring>
#include <memory>
#include <string>
#include <type_traits>
#include <vector>

#include "hls_kernels/native/sizes.hpp"
#include "hls_kernels/native/toolset.hpp"
#include "hls_kernels/vocabulary.hpp"

namespace photonloom_hls {

// Packets that came out of a stream, packed, each with the cycle in which it was written.
struct Taken {
  std::vector<uint32_t> words;
  std::vector<uint64_t> cycles;
};

// How many cycles the far end of port `port` lets pass before its next packet: 0 is the first port,
// an input, those that follow are outputs.
struct FarEnd {
  uint64_t (*gap)(void* owner, int port);
  void* owner;
  void hold(int port) const { pass(gap(owner, port)); }
};

template <class P>
using Word = typename Native::bits<P::kBits>;

// A process that feeds packed packets into a stream.
template <class P>
void add_source(Simulation& simulation, Stream<P>& stream, const FarEnd& far_end,
                const uint32_t* words, size_t packets) {
  simulation.add("source", [&stream, &far_end, words, packets] {
    for (size_t i = 0; i < packets; ++i) {
      Word<P> word;
      std::memcpy(word.words(), words + i * Word<P>::kWords, sizeof(uint32_t) * Word<P>::kWords);
      P packet;
      unpack<Native>(word, packet);
      far_end.hold(0);
      stream.write(packet);
    }
  });
}

// A process that takes whatever comes.
template <class P>
void add_taker(Simulation& simulation, Stream<P>& stream, const FarEnd& far_end, int port,
               Taken& taken) {
  simulation.add(
      "taker",
      [&stream, &far_end, &taken, port] {
        for (;;) {
          uint64_t cycle = 0;
          const P packet = stream.read(cycle);
          Word<P> word;
          pack<Native>(packet, word);
          taken.words.insert(taken.words.end(), word.words(), word.words() + Word<P>::kWords);
          taken.cycles.push_back(cycle);
          far_end.hold(port);
        }
      },
      true);
}

class Shell {
 public:
  Shell(uint64_t seed, const FarEnd& far_end) : simulation_(seed), far_end_(far_end) {}
  virtual ~Shell() = default;
  // Runs the kernel on packed packets; what stopped it, empty where nothing did.
  const char* run(const uint32_t* words, size_t packets) {
    for (Taken& t : taken_) t = {};
    in_cycles_.clear();
    problem_ = simulate(words, packets);
    return problem_.c_str();
  }
  // One write of the unit's configuration port.
  virtual void configure(uint32_t, uint64_t) {}
  // The lines of a map, as bytes.
  virtual void load_lines(int, const uint8_t*, size_t) {}

  const Taken& taken(int stream) const { return taken_[stream]; }
  const std::vector<uint64_t>& in_cycles() const { return in_cycles_; }
  uint64_t cycles() const { return simulation_.cycle(); }
  const std::vector<LoopCount>& loops() const { return simulation_.loops(); }

 protected:
  virtual std::string simulate(const uint32_t* words, size_t packets) = 0;

  Simulation simulation_;
  FarEnd far_end_;
  Taken taken_[2];
  std::vector<uint64_t> in_cycles_;

 private:
  std::string problem_;
};

// A kernel of one stream in and one out.
template <class Kernel, class In, class Out>
class StreamShell final : public Shell {
 public:
  using Shell::Shell;

 private:
  std::string simulate(const uint32_t* words, size_t packets) override {
    Stream<In> in("in", kPortDepth);
    Stream<Out> out("out", kPortDepth);
    in.watch_reads(&in_cycles_);
    add_source(simulation_, in, far_end_, words, packets);
    simulation_.add("run", [&] { kernel_->run(in, out, packets); });
    add_taker(simulation_, out, far_end_, 1, taken_[0]);
    return simulation_.run();
  }
  std::unique_ptr<Kernel> kernel_ = std::make_unique<Kernel>();
};

// Of a kernel with the toolset Sizes: its members, and what the streams within it hold.
template <class Kernel>
constexpr uint64_t state_bits() {
  using Places = typename Kernel::StreamPlaces;
  return sizeof(Kernel) + (std::is_empty_v<Places> ? 0 : sizeof(Places));
}

// A new shell of the unit that this object holds.
std::unique_ptr<Shell> make_shell(uint64_t seed, const FarEnd& far_end);

}  // namespace photonloom_hls

#define PHOTONLOOM_HLS_EXPORT extern "C" __attribute__((visibility("default")))
#define PHOTONLOOM_HLS_INTERFACE(Kernel)                                                        \
  PHOTONLOOM_HLS_EXPORT uint64_t kernel_state_bits() {                                          \
    return photonloom_hls::state_bits<photonloom_hls::Kernel<photonloom_hls::Sizes>>();         \
  }                                                                                             \
  PHOTONLOOM_HLS_EXPORT void* kernel_create(uint64_t seed, uint64_t (*gap)(void*, int),         \
                                            void* owner) {                                      \
    return photonloom_hls::make_shell(seed, photonloom_hls::FarEnd{gap, owner}).release();      \
  }                                                                                             \
  PHOTONLOOM_HLS_EXPORT void kernel_destroy(void* shell) {                                      \
    delete static_cast<photonloom_hls::Shell*>(shell);                                          \
  }                                                                                             \
  PHOTONLOOM_HLS_EXPORT const char* kernel_run(void* shell, const uint32_t* words,              \
                                               size_t packets) {                                \
    return static_cast<photonloom_hls::Shell*>(shell)->run(words, packets);                     \
  }                                                                                             \
  PHOTONLOOM_HLS_EXPORT void kernel_configure(void* shell, uint32_t address, uint64_t data) {   \
    static_cast<photonloom_hls::Shell*>(shell)->configure(address, data);                       \
  }                                                                                             \
  PHOTONLOOM_HLS_EXPORT void kernel_load_lines(void* shell, int map, const uint8_t* bytes,      \
                                               size_t size) {                                   \
    static_cast<photonloom_hls::Shell*>(shell)->load_lines(map, bytes, size);                   \
  }                                                                                             \
  PHOTONLOOM_HLS_EXPORT size_t kernel_taken(void* shell, int stream, const uint32_t** words,    \
                                            const uint64_t** cycles) {                          \
    const auto& taken = static_cast<photonloom_hls::Shell*>(shell)->taken(stream);              \
    *words = taken.words.data();                                                                \
    *cycles = taken.cycles.data();                                                              \
    return taken.cycles.size();                                                                 \
  }                                                                                             \
  PHOTONLOOM_HLS_EXPORT size_t kernel_in_cycles(void* shell, const uint64_t** cycles) {         \
    const auto& in_cycles = static_cast<photonloom_hls::Shell*>(shell)->in_cycles();            \
    *cycles = in_cycles.data();                                                                 \
    return in_cycles.size();                                                                    \
  }                                                                                             \
  PHOTONLOOM_HLS_EXPORT uint64_t kernel_cycles(void* shell) {                                   \
    return static_cast<photonloom_hls::Shell*>(shell)->cycles();                                \
  }                                                                                             \
  PHOTONLOOM_HLS_EXPORT const char* kernel_loop(void* shell, size_t number, unsigned* interval, \
                                                uint64_t* turns) {                              \
    const auto& loops = static_cast<photonloom_hls::Shell*>(shell)->loops();                    \
    if (number >= loops.size()) return nullptr;                                                 \
    *interval = loops[number].interval;                                                         \
    *turns = loops[number].turns;                                                               \
    return loops[number].process.c_str();                                                       \
  }
