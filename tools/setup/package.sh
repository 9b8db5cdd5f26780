#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Debian packages in build/package[-ARCHITECTURE]: libplvo0, libplvo-dev, plvo-tools, python3-plvo. lintian reads them. Those
# of this machine's architecture are then tried in a clean Debian 12: installed with apt, used from C, C++ and Python, and
# purged (as root; it fetches some 200 MB of Debian's packages).
# usage: tools/setup/package.sh [arm64|armhf]
set -euo pipefail
cd "$(dirname "$0")/../.."
. tools/setup/packages.sh
. tools/setup/sysroot.sh

architecture=${1:-$(dpkg --print-architecture)}
# shellcheck disable=SC2086  # lists of words
case "${1:-}" in
  "")
    build=build/package
    install_packages $PLVO_PACKAGES_BUILD $PLVO_PACKAGES_PYTHON lintian mmdebstrap
    cmake --preset package >&2
    ;;
  arm64 | armhf)
    build=build/package-$architecture
    install_packages $PLVO_PACKAGES_BUILD $PLVO_PACKAGES_CROSS lintian
    make_sysroot "$architecture" "$PWD/build/sysroot-$architecture"
    if [ "$architecture" = arm64 ]; then preset=raspberry-pi-64; else preset=raspberry-pi-32; fi
    cmake --preset $preset -B "$build" -DCMAKE_INSTALL_PREFIX=/usr -DPLVO_BUILD_TESTS=OFF >&2
    ;;
  *)
    say "usage: tools/setup/package.sh [arm64|armhf]"
    exit 2
    ;;
esac

say "building $build"
cmake --build "$build" --parallel "$(nproc)" >&2
rm -f "$build"/*.deb
(cd "$build" && cpack >&2)
debs=("$build"/*_"$architecture".deb)
lintian --fail-on error "${debs[@]}" >&2
say "lintian has no error to tell of"
if [ $# -gt 0 ]; then
  printf '%s\n' "${debs[@]}"
  exit
fi

if [ "$(id -u)" -ne 0 ]; then
  say "to try them in a clean root: sudo $0"
  printf '%s\n' "${debs[@]}"
  exit
fi
root=$(mktemp -d)
trap 'rm -rf "$root"' EXIT
say "making a clean Debian 12 in $root"
sources=(/etc/apt/sources.list.d/debian.sources)
if [ ! -e "${sources[0]}" ]; then sources=(/etc/apt/sources.list); fi
mmdebstrap --quiet --variant=apt bookworm "$root" "${sources[@]}" >&2
mkdir "$root/try"
cp "${debs[@]}" "$root/try"
cp -r tests/house/consumer docs/python.md tools/packaging/try.sh "$root/try"
sed -n '/^```c$/,/^```$/{/^```/d;p}' docs/c.md >"$root/try/track_folder.c"
env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root chroot "$root" /bin/bash /try/try.sh
say "installed, used and purged; the packages:"
printf '%s\n' "${debs[@]}"
