// SPDX-License-Identifier: Apache-2.0
// What the kernels' testbenches share. A packet stands in recorded data as words of 32 bits, the
// least significant first. Natively streams are bounded and processes run beside each other; in a
// vendor's C simulation streams are not, so all goes in, the call is made, all comes out.
#pragma once
#include <cstdint>
#include <cstdio>
#include <functional>
#include <string>
#include <vector>

#include "hls_kernels/toolset.hpp"
#include "hls_kernels/vocabulary.hpp"

// Catapult's SCVerify finds testbench and design by these names.
#if defined(CCS_SCVERIFY)
#include <mc_scverify.h>
#define HLS_MAIN CCS_MAIN(int, char**)
#define HLS_DESIGN(function) CCS_DESIGN(function)
#else
#define HLS_MAIN int main()
#define HLS_DESIGN(function) function
#endif

namespace photonloom_hls {

template <int W>
void from_words(const uint32_t* words, typename Tool::template bits<W>& word) {
  for (int i = 0; i < W / 32; ++i)
    Tool::set_slice(word, 32u * static_cast<unsigned>(i), Tool::uint<32>(words[i]));
  if constexpr (W % 32 != 0)
    Tool::set_slice(word, 32u * (W / 32), Tool::uint<W % 32>(words[W / 32]));
}

template <int W>
std::vector<uint32_t> to_words(const typename Tool::template bits<W>& word) {
  std::vector<uint32_t> words;
  for (int i = 0; i < W / 32; ++i)
    words.push_back(Tool::template slice<32>(word, 32u * static_cast<unsigned>(i)).to_uint());
  if constexpr (W % 32 != 0)
    words.push_back(Tool::template slice<W % 32>(word, 32u * (W / 32)).to_uint());
  return words;
}

class Testbench {
 public:
  explicit Testbench(const char* unit) : unit_(unit) {}

  // These packets go into a stream.
  template <class P>
  void feed(Tool::stream<P>& stream, const uint32_t* words, unsigned packets) {
    start("source", false, [&stream, words, packets] {
      for (unsigned i = 0; i < packets; ++i) {
        typename Tool::template bits<P::kBits> word = {};
        from_words<P::kBits>(words + i * kWords<P>, word);
        P packet;
        unpack<Tool>(word, packet);
        stream.write(packet);
      }
    });
  }

  // The call of the top function.
  void call(std::function<void()> top) { start("kernel", false, std::move(top)); }

  // These packets, and no more, come out of a stream.
  template <class P>
  void expect(const char* name, Tool::stream<P>& stream, const uint32_t* words, unsigned packets) {
    expected_.push_back({name, words, packets, kWords<P>, {}});
    const size_t at = expected_.size() - 1;
    start("taker", true, [this, &stream, at] {
      while (more(stream)) {
        const P packet = stream.read();
        typename Tool::template bits<P::kBits> word = {};
        pack<Tool>(packet, word);
        for (const uint32_t w : to_words<P::kBits>(word)) expected_[at].got.push_back(w);
      }
    });
  }

  // Compares; the exit status.
  int finish() {
    std::string problem = run();
    unsigned compared = 0;
    for (const Expected& e : expected_) {
      const size_t got = e.got.size() / e.words_each;
      for (size_t i = 0; problem.empty() && i < got && i < e.packets; ++i, ++compared)
        for (size_t w = i * e.words_each; w < (i + 1) * e.words_each; ++w)
          if (e.got[w] != e.words[w] && problem.empty())
            problem = std::string("stream ") + e.name + ", packet " + std::to_string(i) +
                      ", word " + std::to_string(w - i * e.words_each) + ": is " +
                      std::to_string(e.got[w]) + ", expected " + std::to_string(e.words[w]);
      if (problem.empty() && got != e.packets)
        problem = std::string("stream ") + e.name + ": " + std::to_string(got) +
                  " packets, expected " + std::to_string(e.packets);
    }
    if (problem.empty())
      std::printf("%s: %u packets as recorded\n", unit_, compared);
    else
      std::printf("%s: %s\n", unit_, problem.c_str());
    return problem.empty() ? 0 : 1;
  }

 private:
  struct Expected {
    const char* name;
    const uint32_t* words;
    unsigned packets;
    size_t words_each;
    std::vector<uint32_t> got;
  };
  template <class P>
  static constexpr size_t kWords = (P::kBits + 31) / 32;

#if defined(PHOTONLOOM_HLS_NATIVE)
  void start(const char* name, bool serves, std::function<void()> body) {
    simulation_.add(name, std::move(body), serves);
  }
  template <class E>
  static bool more(Stream<E>&) {
    return true;  // a taker waits until the run ends
  }
  std::string run() { return simulation_.run(); }
  Simulation simulation_{1};
#else
  void start(const char*, bool, std::function<void()> body) { body(); }
#if defined(PHOTONLOOM_HLS_VITIS)
  template <class E>
  static bool more(hls::stream<E>& stream) {
    return !stream.empty();
  }
#else
  template <class E>
  static bool more(ac_channel<E>& stream) {
    return stream.available(1);
  }
#endif
  static std::string run() { return ""; }
#endif

  const char* unit_;
  std::vector<Expected> expected_;
};

}  // namespace photonloom_hls
