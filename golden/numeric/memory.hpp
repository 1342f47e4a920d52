// SPDX-License-Identifier: Apache-2.0
// What large requests of the user take.
#pragma once
#include <new>
#include <stdexcept>
#include <string>

namespace photonloom {

// f(); where memory runs out in it, the error says for what.
template <class F>
auto with_memory_for(const std::string& what, const F& f) {
  try {
    return f();
  } catch (const std::bad_alloc&) {
    throw std::runtime_error("not enough memory for " + what + ", expected fewer");
  }
}

template <class F>
auto with_memory_for_pixels(int width, int height, const F& f) {
  return with_memory_for(
      "a frame of " + std::to_string(width) + "x" + std::to_string(height) + " pixels", f);
}

}  // namespace photonloom
