#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# usage: package.sh PHOTONLOOM SOURCE: a kernel package is the same bytes each time, is told when it is stale, holds no word of where
# it was made, and its own testbench runs by a C++ compiler alone, out of reach of the sources; a wrong packet fails it.
set -u
program=$1 source=$2
fail() {
  echo "package.sh: $1"
  exit 1
}
work=$(mktemp -d) && trap 'rm -rf "$work"' EXIT
"$program" plan "$source/scenes/cornell.xml" --size 8x8 --spp 1 --gather-rays 4 --k 4 --photons 500 --set reorder.key=hilbert \
  --set reorder.packets=20 --set sampler.cell_bits=2 -o "$work/plan.toml" >/dev/null || fail "no plan"
for name in one two; do
  "$program" generate "$work/plan.toml" -o "$work/$name" --hls >/dev/null || fail "generate --hls fails"
done
diff -r "$work/one" "$work/two" >/dev/null || fail "two packages of one plan differ"
"$program" generate --check "$work/one" >/dev/null || fail "a fresh package is called stale"
echo >>"$work/two/hls/data/reorder_buffer.hpp"
"$program" generate --check "$work/two" >/dev/null 2>&1 && fail "a changed kernel package is not called stale"
grep -rqF -e "$source" -e "$work" "$work/one/hls" && fail "the package names a folder of this machine"

mv "$work/one/hls" "$work/alone" && rm -rf "$work/one" "$work/two" || exit 1
cd "$work/alone" || exit 1
units=$(ls data | sed 's/\.hpp$//')
[ "$(echo "$units" | wc -l)" -eq 3 ] || fail "expected three kernels, found: $units"
said=$(env -i PATH="$PATH" make -s CXX=g++ UNITS="reorder_buffer cdf_sampler" 2>&1) || fail "the testbench fails: $said"
[ "$(echo "$said" | grep -c 'packets as recorded$')" -eq 2 ] || fail "a testbench did not run: $said"
# Golden's first words become other ones.
sed -i '/^constexpr uint32_t out\[\]/,$ s/^    0x[0-9a-f]*u/    0x1u/' data/reorder_buffer.hpp
env -i PATH="$PATH" make -s CXX=g++ UNITS=reorder_buffer >log 2>&1 && fail "a wrong packet is not found"
grep -q 'reorder_buffer: stream out, packet 0, word 0: is [0-9]*, expected [0-9]*' log || fail "no first divergence: $(cat log)"
said=$(env -i PATH="$PATH" make -s TOOL=bogus 2>&1) && fail "a tool that there is not is taken"
[ "$(echo "$said" | grep -c .)" -eq 1 ] && echo "$said" | grep -q 'TOOL is bogus, expected native, vitis or catapult' || fail "TOOL=bogus says: $said"
exit 0
