# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=bash
# Creates a folder of Debian packages of another architecture with all their dependencies. It does not touch this machine's
# own packages and does not need root. Source it after packages.sh.

# The libraries that plvo links on a board, and the packages to build and test its Python package.
PLVO_PACKAGES_BOARD="pybind11-dev python3-dev python3-numpy libc6-dev libstdc++-12-dev libeigen3-dev libfmt-dev libcli11-dev libspng-dev libturbojpeg0-dev libyaml-cpp-dev
  nlohmann-json3-dev libopenni2-dev libusb-1.0-0-dev libfreenect-dev libmicrohttpd-dev libbz2-dev liblz4-dev libzstd-dev libsqlite3-dev"

# make_sysroot ARCHITECTURE FOLDER: does nothing if the folder is complete.
make_sysroot() {
  local architecture=$1 folder=$2 apt=$2.apt options package
  # shellcheck disable=SC2086  # a list of words
  set -- $PLVO_PACKAGES_BOARD
  if [ "$(cat "$folder/.packages" 2>/dev/null)" = "$*" ]; then
    say "$folder has all $# packages"
    return
  fi
  say "fetching $# packages for $architecture, with what they need"
  rm -rf "$folder"
  mkdir -p "$folder" "$apt/lists/partial" "$apt/archives/partial"
  : >"$apt/status"  # an empty status: no package counts as installed, so apt fetches all of them
  options=(-o "Dir::State=$apt" -o "Dir::State::lists=$apt/lists" -o "Dir::State::status=$apt/status" -o "Dir::Cache=$apt"
    -o "APT::Architecture=$architecture" -o "APT::Architectures=$architecture" -o Debug::NoLocking=1 -qq)
  apt-get "${options[@]}" update >&2 || say "not every list of packages could be fetched; going on with those that could"
  apt-get "${options[@]}" -y --no-install-recommends --download-only install "$@" >&2
  for package in "$apt"/archives/*.deb; do dpkg-deb -x "$package" "$folder"; done
  # Makes absolute links relative, since they would point outside the folder.
  find "$folder" -type l -lname '/*' | while read -r link; do
    ln -snf "$(realpath -m --relative-to="$(dirname "$link")" "$folder$(readlink "$link")")" "$link"
  done
  rm -rf "$apt"
  echo "$*" >"$folder/.packages"
}
