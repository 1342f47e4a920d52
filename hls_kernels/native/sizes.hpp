// SPDX-License-Identifier: Apache-2.0
// A toolset whose integers are as many bytes as they have bits: sizeof(KERNEL<Sizes>) is the bits
// of a kernel's members. Its streams are not among them: StreamPlaces is what they hold.
#pragma once

namespace photonloom_hls {

struct Sizes {
  template <int W>
  struct uint {
    char bit[W];
  };
  template <int W>
  struct sint {
    char bit[W];
  };
  template <int W>
  struct bits {
    char bit[W];
  };
  template <class E>
  struct stream {};
};

}  // namespace photonloom_hls
