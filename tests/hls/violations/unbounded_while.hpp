// SPDX-License-Identifier: Apache-2.0
// expected: a loop without a stated bound
#pragma once
#include "hls_kernels/vocabulary.hpp"

namespace photonloom_hls {

template <class T>
class UnboundedWhile {
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
    Word y = x;
    while (y < 100) y = y + y;
    return y;
  }
};

}  // namespace photonloom_hls
