#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# usage: page.sh SOURCE PHOTONLOOM DIR: pages of a run, of a run that diverges and of studies, in Chromium. Screenshots
# are left in DIR/screenshots.
set -u
. "$(dirname "$0")/node.sh"
source=$1 photonloom=$2 dir=$3
command -v chromium >/dev/null 2>&1 || { echo "skipped: there is no chromium on this machine (scripts/setup test-full)"; exit 77; }
node_modules "$source" "$dir"
cp "$source"/tests/report/*.mjs "$dir"
cd "$dir" || exit 1
frame="$source/scenes/cornell_balls.xml --spp 1 --gather-rays 8 --k 8 --photons 20000 --caustic-photons 8000 --work models"
$photonloom cosim $frame --size 32x32 -o run >cosim.log 2>&1 || { cat cosim.log; exit 1; }
# A planted bug, for a page with a first divergence.
rm -rf rtl && cp -R "$source/rtl" rtl
sed -i 's/result.flux = flux;/result.flux = ~flux;/' rtl/photon_gatherer/photon_gatherer_results.sv
if $photonloom cosim $frame --size 8x8 --rtl rtl --backend photon_gatherer=rtl --keep-going -o wrong >wrong.log 2>&1; then
  echo "the planted bug made no difference"
  exit 1
fi
cat >study.toml <<END
[study]
name = "small"
scenes = ["$source/scenes/cornell_balls.xml", "$source/scenes/cornell.xml"]
seeds = [1, 2]
size = "16x16"
measure = ["visible", "formats", "gather", "resources"]
[references]
spp = 16
[gather]
queries = 64
[base]
photons = 4000
caustic_photons = 2000
frame.spp = 2
frame.gather_rays = 4
[[points]]
strategy = "grid"
lines = { gather.k = [4, 8, 16], photon.position_bits = [10, 12] }
[[points]]
strategy = "list"
lines = [{ photon.photon_bytes = 5 }]
END
$photonloom sweep study.toml -o study >sweep.log 2>&1 || { cat sweep.log; exit 1; }
# Images of the size test; few samples: noise does not compress.
for n in 1 2; do
  $photonloom render "$source/scenes/cornell_balls.xml" --integrator path --size 512x512 --spp 4 --seed $n -o traced$n.exr >render.log 2>&1 &&
    $photonloom render "$source/scenes/cornell_balls.xml" --size 512x512 --spp 1 --gather-rays 4 --k 8 --photons 20000 \
      --caustic-photons 8000 --seed $n -o layers$n.exr >>render.log 2>&1 || { cat render.log; exit 1; }
done
PHOTONLOOM=$photonloom PHOTONLOOM_SOURCE=$source exec node page_test.mjs
