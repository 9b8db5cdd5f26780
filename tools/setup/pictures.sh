#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Creates the images of the front page from plvo's own output: the overlays of a recorded and a simulated frame, a report in
# a browser, and the simulated scenes. The recording is TUM's freiburg1_rpy from frame 100 on.
# usage: tools/setup/pictures.sh FOLDER
set -euo pipefail
cd "$(dirname "$0")/../.."
source tools/setup/packages.sh

if [ $# -ne 1 ]; then
  say "usage: tools/setup/pictures.sh FOLDER   (freiburg1_rpy from its frame 100 on, as a TUM folder)"
  exit 2
fi
recording=$(realpath "$1")
install_packages imagemagick chromium fonts-liberation
# What was built here, else what a package installed.
plvo=build/release/bin/plvo
if [ ! -x "$plvo" ]; then plvo=$(command -v plvo) || { say "build it first: tools/setup/demo.sh"; exit 1; }; fi
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

"$plvo" run "$recording" --camera-model tum-fr1 --quiet --overlay "$work/real" --report "$work/report.html"
"$plvo" run --camera sim --scene corridor --light varying --seed 3 --frames 0:51 --quiet --overlay "$work/simulated"
convert "$work/real/000120.png" "$work/simulated/000050.png" +append -quality 80 docs/images/tracking.jpg

chromium --headless --no-sandbox --disable-gpu --hide-scrollbars --user-data-dir="$work/profile" --virtual-time-budget=5000 \
  --window-size=1280,1345 --screenshot="$work/report.png" "file://$work/report.html#t=4" > "$work/log" 2>&1
convert "$work/report.png" -quality 82 docs/images/report.jpg
pictures=()
for light in constant varying; do
  for scene in corridor staircase hall desk bare; do
    "$plvo" simulate --scene "$scene" --light "$light" --seed 7 --frames 10 --quiet --out "$work/$scene.$light"
    pictures+=("$(find "$work/$scene.$light/rgb" -name '*.png' | sort | tail -1)")
  done
done
montage "${pictures[@]}" -tile 5x2 -geometry 320x240+1+1 -quality 80 docs/images/simulator.jpg
say "written: docs/images/tracking.jpg report.jpg simulator.jpg"
