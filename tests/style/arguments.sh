#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# usage: arguments.sh SOURCE: scripts that work for long and write into the tree, in a copy of it: --help tells with status 0, a
# wrong argument with one sentence and status 2, and neither leaves anything behind.
set -u
source=$1
tree=$(mktemp -d) && trap 'rm -rf "$tree"' EXIT
mkdir -p "$tree/golden/plan" "$tree/tests/fuzz"
cp "$source/golden/plan/units.hpp" "$tree/golden/plan/"
cp "$source/README.md" "$source/Makefile" "$tree/"
cp -R "$source/scripts" "$source/docs" "$source/fpga" "$source/studies" "$source/study" "$tree/"
cd "$tree" || exit 1
state() { find . ! -name '*.pyc' ! -name __pycache__ -printf '%p %y %m %s %T@\n'; }
before=$(state)
failed=0
tell() { printf '%s\n' "$*"; failed=1; }
unchanged() { [ "$(state)" = "$before" ] || { tell "$1: changed the tree"; before=$(state); }; }
helps() {  # SCRIPT
  said=$(timeout 30 "scripts/$1" --help 2>&1) || tell "$1 --help: status $?"
  printf '%s\n' "$said" | grep -qE "^usage: $1|^[A-Z]" || tell "$1 --help: said: $said"
  unchanged "$1 --help"
}
refuses() {  # SCRIPT ARGUMENT...
  script=$1 status=0
  shift
  said=$(timeout 30 "scripts/$script" "$@" 2>&1) || status=$?
  [ $status = 2 ] || tell "$script $*: status $status, expected 2"
  [ "$(printf '%s\n' "$said" | grep -c "^$script: ")" = 1 ] || tell "$script $*: expected one sentence, it said: $said"
  unchanged "$script $*"
}
for name in plan-promise tradeoffs cycle-fit engine-predictions time-to-image scene-table studies soak demo gallery precision references asan tsan \
  golden-images fuzz bench board-sim; do
  helps "$name"
  refuses "$name" --nonsense
done
for name in mutate bench-rtl test-hls extremes hls-subset nsga2 hls-table large-scenes; do helps "$name"; done
for name in test-hls hls-subset nsga2 hls-table large-scenes; do refuses "$name" --nonsense; done
refuses plan-promise work/ none
refuses plan-promise none
refuses tradeoffs --check work
refuses tradeoffs work more
refuses fpga --dry-run --page README.md
refuses fpga --dry-run --board up5k --placer static
refuses cycle-fit none.csv
refuses cycle-fit none.csv none.csv
refuses cycle-fit --check none.csv none.csv
refuses engine-predictions none
refuses engine-predictions --check frames
refuses time-to-image work more
refuses scene-table work
refuses studies none
for packets in 1e6 0 -1 99999999999999; do refuses soak "$packets"; done
refuses soak 1 2
refuses demo --readme --nonsense
refuses demo work --readme
refuses gallery work more
refuses references 0
refuses references 1048577
refuses fuzz 1m
refuses fuzz 1 none
refuses fuzz --update 1 exr_image
# Renders that fail leave the sums as they are.
mkdir -p build && printf '#!/bin/sh\nexit 1\n' >build/photonloom && chmod +x build/photonloom
cp "$source/tests/golden_images.sha256" tests/
scripts/golden-images --update >/dev/null 2>&1 && tell "golden-images --update: status 0 without a render"
cmp "$source/tests/golden_images.sha256" tests/golden_images.sha256 || tell "golden-images --update: changed the sums"
exit $failed
