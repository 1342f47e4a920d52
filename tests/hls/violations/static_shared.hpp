// SPDX-License-Identifier: Apache-2.0
// expected: static state
#pragma once
#include "hls_kernels/vocabulary.hpp"

namespace photonloom_hls {

inline int shared_count = 0;  // of every kernel that includes this

template <class T>
class StaticShared {
  using Word = typename T::template uint<16>;

 public:
  void run(typename T::template stream<Word>& in, typename T::template stream<Word>& out,
           const Word* memory, const Word& packets) {
    for (Word i = 0; i < packets; ++i) {
      HLS_PIPELINE(1);
      out.write(step(in.read(), memory));
    }
  }

 private:
  Word step(const Word& x, [[maybe_unused]] const Word* memory) {
    shared_count = shared_count + 1;
    return x + shared_count;
  }
};

}  // namespace photonloom_hls
