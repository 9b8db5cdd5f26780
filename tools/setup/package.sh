#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Builds Debian packages in build/package[-ARCHITECTURE] with dpkg-buildpackage, from a copy of these sources: libplvo0, libplvo-dev,
# plvo-tools, python3-plvo, and of this machine's architecture the source package and ros-plvo; checks them with lintian. Packages of
# this machine's architecture are then tested in a clean Debian 12: installed with apt, used from C, C++ and Python, and purged (as
# root; it downloads about 200 MB of Debian packages). pip installs the same sources into an environment of Python. Packages of a
# board run under emulation.
# usage: tools/setup/package.sh [arm64|armhf]
set -euo pipefail
cd "$(dirname "$0")/../.."
. tools/setup/packages.sh
. tools/setup/sysroot.sh

architecture=${1:-$(dpkg --print-architecture)}
# shellcheck disable=SC2086  # lists of words
case "${1:-}" in
  "")
    build=$PWD/build/package
    install_packages $PLVO_PACKAGES_BUILD $PLVO_PACKAGES_PYTHON $PLVO_PACKAGES_ROS $PLVO_PACKAGES_PACKAGING \
      mmdebstrap python3-pip python3-venv
    options=()
    ;;
  arm64 | armhf)
    build=$PWD/build/package-$architecture
    install_packages $PLVO_PACKAGES_BUILD $PLVO_PACKAGES_CROSS $PLVO_PACKAGES_PACKAGING
    make_sysroot "$architecture" "$PWD/build/sysroot-$architecture"
    if [ "$architecture" = arm64 ]; then triplet=aarch64-linux-gnu; else triplet=arm-linux-gnueabihf; fi
    # -d: what is linked comes from the folder of the board's packages, not from this machine's.
    options=(--build=binary --host-arch="$architecture" "--build-profiles=cross,nocheck" -d)
    ;;
  *)
    say "usage: tools/setup/package.sh [arm64|armhf]"
    exit 2
    ;;
esac

say "building $build"
rm -rf "$build"
source=$build/plvo-$(dpkg-parsechangelog -S Version)
mkdir -p "$source/build"
tar --exclude=./build --exclude=./.git --exclude=__pycache__ -c . | tar -x -C "$source"
if [ -e .git ]; then git describe --always --abbrev=12 --exclude='*' --dirty=+changes >"$source/debian/commit"; fi
if [ $# -gt 0 ]; then ln -s "$PWD/build/sysroot-$architecture" "$source/build"; fi
(cd "$source" && dpkg-buildpackage --no-sign --jobs="$(nproc)" "${options[@]}" >&2)
debs=("$build"/*_"$architecture".deb)
lintian --fail-on error --allow-root "$build"/*.changes >&2
say "lintian has no error to tell of"
if [ $# -gt 0 ]; then
  say "trying what is in them under emulation"
  work=$(mktemp -d)
  trap 'rm -rf "$work"' EXIT
  for deb in "${debs[@]}"; do dpkg-deb -x "$deb" "$work"; done
  sysroot=$PWD/build/sysroot-$architecture
  if [ "$architecture" = arm64 ]; then emulator=qemu-aarch64; else emulator=qemu-arm; fi
  board=("$emulator" -L "$sysroot" -E "LD_LIBRARY_PATH=$work/usr/lib/$triplet")
  "${board[@]}" "$work/usr/bin/plvo" --version >&2
  "${board[@]}" "$work/usr/bin/plvo" simulate --out "$work/sequence" --frames 6 --size 320x240 --quiet
  "${board[@]}" "$work/usr/bin/plvo" run "$work/sequence" --quiet --out "$work/run.txt"
  "${board[@]}" "$work/usr/bin/plvo" run "$work/sequence" --imu --quiet --out "$work/imu.txt"
  for program in 1:run 5:imu; do  # the two programs of the page; each must print the poses of the command line
    tools/setup/page_program.sh docs/user/c.md c "${program%:*}" >"$work/program.c"
    "$triplet-gcc" --sysroot="$sysroot" -std=c11 -I"$work/usr/include" "$work/program.c" -L"$work/usr/lib/$triplet" -lplvo \
      -Wl,-rpath-link,"$sysroot/usr/lib/$triplet" -o "$work/program"
    "${board[@]}" "$work/program" "$work/sequence" | cut -d' ' -f2- >"$work/c.poses"
    grep -v '^#' "$work/${program#*:}.txt" | cut -d' ' -f2- | cmp - "$work/c.poses"
  done
  say "the command line and two C programs with the shared library agree on $(wc -l <"$work/c.poses") poses each"
  python=("${board[@]}" -E "PYTHONHOME=$sysroot/usr" -E PYTHONDONTWRITEBYTECODE=1
    -E "PYTHONPATH=$work/usr/lib/python3/dist-packages:$sysroot/usr/lib/python3/dist-packages"
    -E "LD_LIBRARY_PATH=$work/usr/lib/$triplet:$sysroot/usr/lib/$triplet/blas:$sysroot/usr/lib/$triplet/lapack" "$sysroot/usr/bin/python3")
  "${python[@]}" - "$work/sequence" >"$work/python.poses" <<'PROGRAM'
import sys
import plvo
for r in plvo.run(sys.argv[1]):
    if r.has_pose:
        print(" ".join(f"{x:.9f}" for x in (*r.position, *r.quaternion)))
PROGRAM
  grep -v '^#' "$work/run.txt" | cut -d' ' -f2- | cmp - "$work/python.poses"
  say "and so does Python"
  printf '%s\n' "${debs[@]}"
  exit
fi

packages_of() { sed 's/([^)]*)//g; s/ //g' | tr , '\n' | sort; }
for pair in LIBRARY:libplvo0 TOOLS:plvo-tools; do
  deb=$(echo "$build/${pair#*:}"_*_"$architecture".deb)
  if ! diff <(dpkg-deb -f "$deb" Depends | packages_of) \
    <(make -s -f debian/rules "print-NEEDED_BY_${pair%:*}" | packages_of) >&2; then
    say "what packages for other architectures depend on (debian/rules) is not what ${pair#*:} needs here"
    exit 1
  fi
done

say "pip install of the same sources"
/usr/bin/python3 -m venv --system-site-packages "$build/env"
"$build/env/bin/pip" install --quiet --no-index --disable-pip-version-check "$source"
(cd "$build" && env/bin/python -c 'import plvo; assert plvo.__file__.startswith("'"$build"'/env/"), plvo.__file__')

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
cp -r tests/architecture/consumer docs/user/python.md tools/packaging/try.sh "$root/try"
tools/setup/page_program.sh docs/user/c.md c >"$root/try/track_folder.c"
tools/setup/page_program.sh docs/user/c.md c 5 >"$root/try/track_with_imu.c"
env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root chroot "$root" /bin/bash /try/try.sh
say "installed, used and purged; the packages:"
printf '%s\n' "${debs[@]}"
