# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=bash disable=SC2034  # the scripts that source this file read the lists
# The single list of the Debian packages for building, testing and cross-building plvo. Other scripts source this file.

# The library, the cameras and the command line.
PLVO_PACKAGES_BUILD="g++ cmake ninja-build pkg-config libeigen3-dev libfmt-dev libcli11-dev libspng-dev libturbojpeg0-dev
  libyaml-cpp-dev nlohmann-json3-dev libopenni2-dev libusb-1.0-0-dev libfreenect-dev libmicrohttpd-dev libbz2-dev
  liblz4-dev libzstd-dev libsqlite3-dev"

# Debian packages: debian/control names these, and what is built with them.
PLVO_PACKAGES_PACKAGING="dpkg-dev debhelper dh-python lintian"

# The Python package is built if these are installed.
PLVO_PACKAGES_PYTHON="pybind11-dev python3-dev python3-numpy"

# The node for ROS 1 is built if these are installed.
PLVO_PACKAGES_ROS="libroscpp-dev libmessage-filters-dev libtf2-ros-dev libnav-msgs-dev libdiagnostic-msgs-dev libstd-srvs-dev"

# The tests: GoogleTest, a second compiler, tools that check the sources, simulated USB devices, a browser for the pages, a counter of
# instructions, ROS's own writers of bags, ROS's master and messages for Python, what there is of ROS 2, compressors, Slurm.
PLVO_PACKAGES_TEST="$PLVO_PACKAGES_PYTHON $PLVO_PACKAGES_ROS python3-pytest python3-pip python3-venv python3-matplotlib googletest libgtest-dev clang
  libclang-rt-dev clang-format clang-tidy umockdev libumockdev-dev chromium fonts-liberation valgrind
  librosbag-storage-dev python3-rosbag python3-roslaunch rosout python3-nav-msgs python3-sensor-msgs python3-diagnostic-msgs
  python3-std-srvs python3-tf2-msgs rosidl-generator-c-cpp librosidl-runtime-c-cpp-dev ament-cmake colcon python3-colcon-ros
  python3-colcon-recursive-crawl python3-colcon-package-selection python3-colcon-library-path ros-sensor-msgs ros-nav-msgs
  ros-diagnostic-msgs ros-std-srvs python3-pil zstd lz4 slurm-wlm"

# The boards: cross compilers and emulators.
PLVO_PACKAGES_CROSS="g++-aarch64-linux-gnu g++-arm-linux-gnueabihf qemu-user gcc-arm-none-eabi libnewlib-arm-none-eabi
  libstdc++-arm-none-eabi-newlib qemu-system-arm"

say() { printf '\033[1mplvo:\033[0m %s\n' "$*" >&2; }

# apt_get WORD…: runs apt-get. If another program, such as an unattended upgrade, holds a lock of apt or dpkg, it waits for up to ten
# minutes. The lock of the package lists has no timeout of its own.
apt_get() {
  local log tries as_root=()
  if [ "$(id -u)" -ne 0 ]; then as_root=(sudo); fi
  log=$(mktemp)
  for tries in {1..120}; do
    if "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive LC_ALL=C apt-get -o DPkg::Lock::Timeout=600 "$@" >&2 2>"$log"; then
      cat "$log" >&2
      rm -f "$log"
      return
    fi
    if ! grep -q "Could not get lock" "$log"; then break; fi
    if [ "$tries" -eq 1 ]; then say "waiting for another program to release apt's lock"; fi
    sleep 5
  done
  cat "$log" >&2
  rm -f "$log"
  return 1
}

# install_packages NAME…: installs the missing packages; uses the network only if a package is missing.
install_packages() {
  local package missing=()
  for package in "$@"; do
    if [ "$(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null)" != installed ]; then missing+=("$package"); fi
  done
  if [ ${#missing[@]} -eq 0 ]; then
    say "all $# packages are installed"
    return
  fi
  say "installing ${#missing[@]} packages: ${missing[*]}"
  # A mirror under update may lack one of its lists; if a package needs that list, the installation below fails.
  apt_get update -qq || say "not every list of packages could be fetched; going on with those that could"
  apt_get install -y -qq --no-install-recommends "${missing[@]}"
}
