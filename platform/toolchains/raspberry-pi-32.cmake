# SPDX-License-Identifier: Apache-2.0
# Raspberry Pi OS 32-bit on an ARMv7 or later (Pi 2, 3, 4, Zero 2), which all have NEON, with Debian's armhf compiler. Not for
# the ARMv6 of the Pi 1 and the first Zero: Debian's compiler has no libraries for it.
include(${CMAKE_CURRENT_LIST_DIR}/armhf-neon.cmake)
set(debian_architecture armhf)
set(triplet arm-linux-gnueabihf)
set(emulator qemu-arm)
include(${CMAKE_CURRENT_LIST_DIR}/debian_sysroot.cmake)
