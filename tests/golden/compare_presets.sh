#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# The same trajectory, byte for byte, from every preset that built the command line: on a simulated sequence, rendered once,
# and on a recorded one where the shared folder is there. compare_presets.sh PRESET… (each already built)
set -euo pipefail
cd "$(dirname "$0")/../.."

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
shared=${PLVO_SHARED:-../shared}
frames=0:12  # enough to see a difference; a debug build is slow

compare() {
  local name=$1 first="" preset
  shift
  for preset in $presets; do
    build/"$preset"/bin/plvo run "$@" --frames "$frames" --out "$work/$name.$preset.txt" >"$work/log" 2>&1 || {
      cat "$work/log" >&2
      exit 1
    }
    if [ -z "$first" ]; then
      first=$preset
      grep -q '^[0-9]' "$work/$name.$preset.txt" || { echo "$name: $preset wrote no poses" >&2; exit 1; }
    elif ! cmp "$work/$name.$first.txt" "$work/$name.$preset.txt" >&2; then
      echo "$name: $first and $preset differ" >&2
      exit 1
    fi
  done
  echo "same bytes from $presets: $name, $(sha256sum <"$work/$name.$first.txt" | cut -c1-16)" >&2
}

presets=""
for preset in "$@"; do
  if [ -x "build/$preset/bin/plvo" ]; then presets="$presets $preset"; fi
done
if [ "$(wc -w <<<"$presets")" -lt 2 ]; then
  echo "nothing to compare:$presets alone has built the command line" >&2
  exit 0
fi

build/"${presets##* }"/bin/plvo simulate --size 320x240 --frames 12 --out "$work/simulated" >"$work/log" 2>&1 || {
  cat "$work/log" >&2
  exit 1
}
compare simulated "$work/simulated"
if [ -d "$shared/data/fr1_desk_9f" ]; then
  compare fr1_desk "$shared/data/fr1_desk_9f" --camera-model tum-fr1
else
  echo "SKIPPED: no recorded sequences at $shared/data; the presets were compared on the simulated sequence only" >&2
fi
