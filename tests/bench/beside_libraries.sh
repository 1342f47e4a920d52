#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# usage: beside_libraries.sh SOURCE BUILD: builds bench/ into BUILD/bench-test. Each program then runs on little: bench_gather
# with the golden gather and all three libraries, bench_meshes on a mesh, of which both readers must find the same triangles,
# and on a file that is none.
set -eu
source=$1
build=$2/bench-test
fail() { echo "beside_libraries: $*" >&2; exit 1; }
mkdir -p "$build"
# CMake tells of each step what it does; it matters where one fails.
{ cmake -S "$source/bench" -B "$build" -G Ninja && cmake --build "$build"; } >"$build/log.txt" 2>&1 || fail "$(cat "$build/log.txt")"

"$build/bench_gather" "$build/uniform.json" --uniform --queries 500 --photons 3000 -k 5 >"$build/uniform.txt" || fail "bench_gather: status $?"
for name in photonloom nanoflann FLANN CGAL; do
  grep -q "$name" "$build/uniform.txt" || fail "bench_gather says nothing of $name: $(cat "$build/uniform.txt")"
done
for wrong in "-k 0" "--queries -1" "--photons 1,x" "--bucket 8" "--cloud $build/none $build/none -k 5"; do
  # shellcheck disable=SC2086 # an option and its value
  status=0
  "$build/bench_gather" "$build/wrong.json" --uniform $wrong 2>"$build/wrong.txt" || status=$?
  [ "$status" -eq 2 ] || fail "bench_gather $wrong ends with status $status, expected 2"
  [ ! -e "$build/wrong.json" ] || fail "bench_gather $wrong wrote a file"
  grep -q -e "${wrong%% *}" "$build/wrong.txt" || fail "bench_gather $wrong does not name the option: $(cat "$build/wrong.txt")"
done
[ -s "$build/uniform.json" ] || fail "bench_gather wrote no $build/uniform.json"

cat >"$build/square.ply" <<'PLY'
ply
format ascii 1.0
element vertex 4
property float x
property float y
property float z
element face 2
property list uchar int vertex_indices
end_header
0 0 0
1 0 0
1 1 0
0 1 0
3 0 1 2
3 0 2 3
PLY
"$build/bench_meshes" "$build/square.ply" >"$build/meshes.txt" || fail "bench_meshes: status $?"
grep -q '"triangles": 2' "$build/meshes.txt" || fail "bench_meshes: $(cat "$build/meshes.txt"), expected 2 triangles"
if "$build/bench_meshes" "$source/bench/CMakeLists.txt" 2>"$build/no_mesh.txt"; then fail "bench_meshes took a file that is no mesh"; fi
grep -q '^bench_meshes: ' "$build/no_mesh.txt" || fail "bench_meshes said: $(cat "$build/no_mesh.txt")"
