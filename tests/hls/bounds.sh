#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# usage: bounds.sh SOURCE BENCH: a kernel that writes beyond one of its arrays ends the bench with a sentence that names file, line
# and array. BENCH is bench_reorder_buffer, with its folder; the compiler is g++, for clang++ does not look.
set -u
source=$1 bench=$2
fail() {
  echo "bounds.sh: $1"
  exit 1
}
work=$(mktemp -d) && trap 'rm -rf "$work"' EXIT
cp -r "$source/hls_kernels" "$work" || exit 1
kernel=$work/hls_kernels/reorder_buffer/reorder_buffer.hpp
sed -i 's/    occupied_\[word\] = changed;/    occupied_[word + bin.to_uint()] = changed;/' "$kernel"
cmp -s "$kernel" "$source/hls_kernels/reorder_buffer/reorder_buffer.hpp" && fail "what the array is written with is not where it was"
said=$(CXX=g++ PHOTONLOOM_HLS=$work/hls_kernels "$bench" --plan sweep --backend hls --work "$work/models" 2>&1)
status=$?
[ $status -ne 0 ] || fail "the bench passed"
printf '%s\n' "$said" | grep -q "hls_kernels/reorder_buffer/reorder_buffer.hpp:[0-9:]* runtime error: index [0-9]* out of bounds for type '.* \[[0-9]*\]'" ||
  fail "expected a sentence of file, line, index and array, but with status $status: $said"
