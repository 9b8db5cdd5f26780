#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Builds the command line with live cameras for Raspberry Pi OS on a Debian machine, against the Debian packages of the
# board's architecture, and tests it under emulation: live frames of the virtual sensor and the same frames from files must
# give the same trajectory.
# usage: tools/setup/board.sh raspberry-pi-64|raspberry-pi-32
set -euo pipefail
cd "$(dirname "$0")/../.."
. tools/setup/packages.sh
. tools/setup/sysroot.sh

case "${1:-}" in
  raspberry-pi-64) architecture=arm64 emulator=qemu-aarch64 ;;
  raspberry-pi-32) architecture=armhf emulator=qemu-arm ;;
  *)
    say "usage: tools/setup/board.sh raspberry-pi-64|raspberry-pi-32"
    exit 2
    ;;
esac
preset=$1
# shellcheck disable=SC2086  # a list of words
install_packages g++ cmake ninja-build pkg-config googletest $PLVO_PACKAGES_CROSS
sysroot=build/sysroot-$architecture
make_sysroot "$architecture" "$PWD/$sysroot"

say "building build/$preset"
if [ ! -f "build/$preset/CMakeCache.txt" ]; then cmake --preset "$preset" -G Ninja >&2; fi
cmake --build --preset "$preset" --parallel "$(nproc)" --target plvo plvo_virtual_driver plvo_virtual_frames >&2

say "trying it under $emulator"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
board=("$emulator" -L "$sysroot" -E "LD_LIBRARY_PATH=$PWD/build/$preset/tests/virtual_openni2")
plvo=build/$preset/bin/plvo
"${board[@]}" "build/$preset/tests/plvo_virtual_frames" "$work/raw" "$work/sequence" 12 >&2
"${board[@]}" "$plvo" run "$work/sequence" --quiet --out "$work/files.txt" >&2
PLVO_VIRTUAL_START="pace 400000" PLVO_VIRTUAL_FRAMES="$work/raw" "${board[@]}" "$plvo" live --mode 320x240 \
  --calibration "$work/sequence/calibration.txt" --every-frame --frames 12 --quiet --out "$work/live.txt" >&2
cmp "$work/files.txt" "$work/live.txt"
if [ "$(wc -l <"$work/live.txt")" -lt 13 ]; then
  say "the live sensor gave too few poses"
  exit 1
fi
say "12 live frames and the same from files: one trajectory, $(sha256sum <"$work/live.txt" | cut -c1-16)"
say "copy $plvo to the board; there: sudo apt install libopenni2-0 libusb-1.0-0 libfreenect0.5 libfmt9 libspng0 libturbojpeg0 libyaml-cpp0.7 libmicrohttpd12 libbz2-1.0 liblz4-1 libzstd1 libsqlite3-0"
