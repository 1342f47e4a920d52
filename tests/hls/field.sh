#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# usage: field.sh SOURCE BUILD FLAGS: a field that is added to a packet's list in a copy is in the kernels' header, and a kernel
# carries it. FLAGS are the compiler's for the libraries of BUILD.
set -u
source=$1 build=$2 flags=$3
fail() {
  echo "field.sh: $1"
  exit 1
}
work=$(mktemp -d) && trap 'rm -rf "$work"' EXIT
mkdir -p "$work/golden/packet" && cd "$work" || exit 1
sed '/#define PHOTONLOOM_GATHER_QUERY(FIELD)/a\  FIELD(uint32_t, colour_of_tea, 1, 5, "", "added in a copy") \\' \
  "$source/golden/packet/packet.hpp" >golden/packet/packet.hpp
grep -q colour_of_tea golden/packet/packet.hpp || fail "the list of gather_query is not where it was"
cat >write.cpp <<'END'
#include <iostream>
#include "hls_kernels/generate/header.hpp"
int main() {
  photonloom::Plan plan;
  plan.global.present = true;
  plan.global.photons = 500;
  plan.reorder_packets = 3;
  plan.reorder_bins = 16;
  std::cout << photonloom::write_hls_header(plan, 0);
}
END
libraries=$(find "$build" -name 'libphotonloom_*.a' | tr '\n' ' ')
# What the program links beside them: several files of a folder are one object, which asks for all that its folder asks for.
others=$(ninja -C "$build" -t commands photonloom | tail -n 1 | tr ' ' '\n' | grep -E '\.so|^-l|\.a$' | grep -v libphotonloom | sort -u | tr '\n' ' ')
# The copy's objects stand in front, so theirs are the packets that count.
g++ -std=c++20 $flags -I. -I"$source" -isystem /usr/include/OpenEXR -isystem /usr/include/Imath write.cpp \
  "$source/hls_kernels/generate/header.cpp" -Wl,--start-group $libraries -Wl,--end-group $others -o write ||
  fail "the header's writer does not compile"
./write >photonloom_hls.hpp
grep -q 'typename T::template uint<5> colour_of_tea;' photonloom_hls.hpp || fail "the kernels' packet has no such field"
cat >run.cpp <<'END'
#include <cstdio>
#include "hls_kernels/native/toolset.hpp"
#include "hls_kernels/reorder_buffer/reorder_buffer.hpp"
using namespace photonloom_hls;
int main() {
  using Query = GatherQuery<Native>;
  Simulation simulation(1);
  Stream<Query> in("in", 2), out("out", 2);
  ReorderBuffer<Native> kernel;
  unsigned got = 0, wrong = 0;
  simulation.add("source", [&] {
    for (unsigned i = 0; i < 6; ++i) {
      Query q;
      q.zero();
      q.tag = i;
      q.colour_of_tea = 31 - i;
      q.flush = i == 5;
      typename Native::bits<Query::kBits> word;
      pack<Native>(q, word);  // as it comes from a host
      unpack<Native>(word, q);
      in.write(q);
    }
  });
  simulation.add("kernel", [&] { kernel.run(in, out, 6); });
  simulation.add("taker", [&] {
    for (; got < 6; ++got) {
      const Query q = out.read();
      if (q.colour_of_tea != 31 - (q.flush == 1 ? 5 : q.tag.to_uint())) ++wrong;
    }
  });
  const std::string problem = simulation.run();
  std::printf("%u packets, %u wrong %s\n", got, wrong, problem.c_str());
  return got == 6 && wrong == 0 && problem.empty() ? 0 : 1;
}
END
g++ -std=c++17 -O1 -Wall -Wextra -Werror -DPHOTONLOOM_HLS_NATIVE -I. -I"$source" run.cpp -o run || fail "the kernel does not compile"
./run || fail "the field does not come out of the kernel"
