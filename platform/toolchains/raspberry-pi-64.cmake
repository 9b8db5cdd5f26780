# SPDX-License-Identifier: Apache-2.0
# Raspberry Pi OS 64-bit (Debian's arm64): Pi 3, 4, 5, Zero 2; other boards with Debian or Ubuntu for arm64 too.
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(debian_architecture arm64)
set(triplet aarch64-linux-gnu)
set(emulator qemu-aarch64)
include(${CMAKE_CURRENT_LIST_DIR}/debian_sysroot.cmake)
