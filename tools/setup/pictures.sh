#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Creates the images of the pages from plvo's own output: the overlays of a recorded and a simulated frame, a report in a browser, the
# simulated scenes, and overlays of hard sequences. The recording is TUM's freiburg1_rpy from frame 100 on. Without it, the hard
# sequences alone.
# usage: tools/setup/pictures.sh [FOLDER]
set -euo pipefail
cd "$(dirname "$0")/../.."
source tools/setup/packages.sh

if [ $# -gt 1 ]; then
  say "usage: tools/setup/pictures.sh [FOLDER]   (freiburg1_rpy from its frame 100 on, as a TUM folder)"
  exit 2
fi
install_packages imagemagick
# What was built here, else what a package installed.
plvo=build/release/bin/plvo
if [ ! -x "$plvo" ]; then plvo=$(command -v plvo) || { say "build it first: tools/setup/demo.sh"; exit 1; }; fi
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# show WORDS FRAME...: the overlays of these frames of a sequence of tools/plvo/bench/studies/moving_world.py join the next picture.
pictures=()
show() {
  local folder="$work/hard$1" frame
  if [ ! -d "$folder" ]; then
    # shellcheck disable=SC2086
    "$plvo" simulate --scene corridor --size 320x240 --frames 80 --seed 5 $1 --quiet --out "$folder"
    "$plvo" run "$folder" --quiet --overlay "$folder/overlay" 2> "$work/log"
  fi
  for frame in "${@:2}"; do pictures+=("$folder/overlay/$(printf %06d "$frame").png"); done
}
# save NAME: writes the pictures in a row as one.
save() {
  convert "${pictures[@]}" -bordercolor white -border 1x0 +append -quality 75 "docs/images/$1.jpg"
  pictures=()
}

show "--with board" 24 44 73; save moving_board
show "--still --with person" 40; show "--with person" 40; show "--with person-ahead" 50; save moving_person
show "--with bumper" 5 20; show "--with clock" 40; save moving_bumper
show "--with dots" 6 7 40; save moving_dots
show "--with mirror" 20 40 70; save moving_mirror
show "--with comb" 20; show "--with frozen-depth" 26 30; save moving_depth
show "--fps 5" 11; show "--covered 40:70" 45 70; save moving_views
say "written: docs/images/moving_*.jpg"
if [ $# -eq 0 ]; then exit; fi
recording=$(realpath "$1")
install_packages chromium fonts-liberation

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
