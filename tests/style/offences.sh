#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# usage: offences.sh SOURCE: plants one offence of each kind in a small tree; scripts/style must name every one.
set -u
source=$1
tree=$(mktemp -d) && trap 'rm -rf "$tree"' EXIT
mkdir -p "$tree/scripts" "$tree/docs" "$tree/golden/numeric" "$tree/golden/scene" "$tree/rtl/odd" "$tree/host" "$tree/tests/units" \
  "$tree/verilator_tb/model"
cp "$source/scripts/style" "$tree/scripts/"
spdx="SPDX-License-Identifier: Apache-2.0"
printf '# %s\nbuild: gcc-undocumented\n' "$spdx" >"$tree/scripts/packages.txt"
printf '| `unlisted` | nothing |\n' >"$tree/docs/dependencies.md"
printf 'int a;\n' >"$tree/golden/numeric/bare.cpp"
printf '// %s\n#include "golden/unit/photon_map.hpp"\n' "$spdx" >"$tree/golden/scene/upwards.cpp"
printf '// %s\n#include "verilator_tb/rig/rig.hpp"\n' "$spdx" >"$tree/host/upwards.cpp"
printf '// %s\n#include "rtl/generate/board.hpp"\n' "$spdx" >"$tree/golden/numeric/through_the_roof.cpp"
printf '// %s\n#include "command/console.hpp"\n' "$spdx" >"$tree/tests/units/roof.cpp"
printf '// %s\n#include "verilator_tb/rig/rig.hpp"\n' "$spdx" >"$tree/verilator_tb/model/upwards.hpp"
printf '// %s\ndouble f(double x) { return std::sin(x); }\n' "$spdx" >"$tree/golden/numeric/libm.cpp"
printf '// %s\n// see %shome/someone/notes\n' "$spdx" / >"$tree/golden/numeric/path.cpp"
printf '// %s\nmodule odd; endmodule\n' "$spdx" >"$tree/rtl/odd/odd.sv"

report=$(cd "$tree" && sh scripts/style) && { echo "style accepted a tree full of offences"; exit 1; }
status=0
expect() { printf '%s\n' "$report" | grep -qF -- "$1" || { echo "style did not report: $1"; status=1; }; }
expect "golden/numeric/bare.cpp: no SPDX line"
expect "golden/scene/upwards.cpp: includes golden/unit/photon_map.hpp, which is not below golden/scene"
expect "host/upwards.cpp: includes verilator_tb/rig/rig.hpp, which is not below host"
expect "golden/numeric/through_the_roof.cpp: includes rtl/generate/board.hpp, which is not below golden"
expect "tests/units/roof.cpp: includes a file of command"
expect "verilator_tb/model/upwards.hpp: includes verilator_tb/rig/rig.hpp, which is not below verilator_tb/model"
expect "golden/numeric/libm.cpp:2:"
expect "golden/numeric/path.cpp:2:"
expect "rtl/odd: there is no golden/unit/odd.cpp"
expect "rtl/odd: there is no docs/odd.md"
expect "docs/dependencies.md: does not say what gcc-undocumented is for"
expect "docs/dependencies.md: unlisted is in no list"
[ $status = 0 ] || printf '%s\n' "It said:" "$report"
exit $status
