#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# usage: offences.sh SOURCE: plants one offence of each kind in a small tree; scripts/style must name every one.
set -u
source=$1
tree=$(mktemp -d) && trap 'rm -rf "$tree"' EXIT
mkdir -p "$tree/scripts" "$tree/docs" "$tree/golden/numeric" "$tree/golden/scene" "$tree/golden/plan" "$tree/golden/unit" "$tree/rtl/odd" "$tree/host" "$tree/tests/units" \
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
printf '| where is | look in |\n|---|---|\n| `x` | `scripts/style`: `no such symbol`; `golden/gone.cpp` |\n| y | `scripts/style`: `offences=` |\n\n' >"$tree/README.md"
printf '// %s\nmodule odd; endmodule\n' "$spdx" >"$tree/rtl/odd/odd.sv"

printf '// %s\n#define UNITS(UNIT) \\\n  UNIT(EvenUnit, even_unit, 1) \\\n  UNIT(Far, far_unit, 2)\n' "$spdx" >"$tree/golden/plan/units.hpp"
printf '// %s\n#include "golden/unit/even_unit.hpp"\n// "even_unit" in words\nconst char* a = "x", *even_unit = "y";\nchar q = %s, r = 0;\nconst char* b = "the even_unit";\n' \
  "$spdx" "'\"'" >"$tree/host/name.cpp"
printf '// %s\nconst char* a = R"(one\ntwo far_unit)";\n' "$spdx" >"$tree/host/raw.cpp"
printf '// %s\nconst char* a = "even_unit";\nconst char* b = "far_unit";\n' "$spdx" >"$tree/golden/unit/even_unit.hpp"

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
expect "README.md: the table \"where is\" names golden/gone.cpp, which is not there"
expect "README.md: the table \"where is\" says that no such symbol stands in scripts/style"
printf '%s\n' "$report" | grep -qF 'says that offences=' && { echo "style reported a symbol that is there"; status=1; }
expect "rtl/odd: there is no golden/unit/odd.cpp"
expect "rtl/odd: there is no docs/odd.md"
expect "rtl/odd: is not in golden/plan/units.hpp"
expect "rtl/odd: there is no hls_kernels/odd/odd.hpp"
expect "golden/plan/units.hpp: there is no rtl/even_unit"
expect "host/name.cpp:6: the even_unit (a unit's name in a string"
expect "host/raw.cpp:2: one"
expect "golden/unit/even_unit.hpp:3: far_unit"
refuse() { printf '%s\n' "$report" | grep -qF -- "$1" && { echo "style reported: $1"; status=1; }; }
refuse "host/name.cpp:2:"
refuse "host/name.cpp:3:"
refuse "host/name.cpp:4:"
refuse "host/name.cpp:5:"
refuse "golden/unit/even_unit.hpp:2:"
expect "docs/dependencies.md: does not say what gcc-undocumented is for"
expect "docs/dependencies.md: unlisted is in no list"
[ $status = 0 ] || printf '%s\n' "It said:" "$report"
exit $status
