#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# From a fresh Debian 12 to a trajectory: installs what is missing, builds, runs the odometry on the simulated camera.
set -euo pipefail
cd "$(dirname "$0")/../.."
. tools/setup/packages.sh

# shellcheck disable=SC2086  # a list of words
install_packages $PLVO_PACKAGES_BUILD

say "building (build/release)"
# Other compilers than GCC 12 may give warnings that it does not give.
werror=()
if [ "$(c++ -dumpversion | cut -d. -f1)" != 12 ]; then werror=(-DPLVO_WERROR=OFF); fi
cmake --preset release "${werror[@]}" >&2
cmake --build --preset release --parallel "$(nproc)" --target plvo >&2

out=build/demo
mkdir -p "$out"
plvo=build/release/bin/plvo
arguments=(run --camera sim --out "$out/trajectory.txt" --stats "$out/stats.csv" --json "$out/summary.json")
# Writes a report for a browser if this build supports it.
if "$plvo" run --help | grep -q -- --report; then arguments+=(--report "$out/report.html"); fi
say "running: $plvo ${arguments[*]}"
"$plvo" "${arguments[@]}"

say "done. Look at:"
for file in "$out"/*; do say "  $file"; done
