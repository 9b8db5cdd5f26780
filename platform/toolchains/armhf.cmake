# SPDX-License-Identifier: Apache-2.0
# Debian's cross compiler for armhf; the tests run under qemu's user-mode emulation.
# Packages: g++-arm-linux-gnueabihf qemu-user (and googletest for the tests).
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR arm)
set(CMAKE_C_COMPILER arm-linux-gnueabihf-gcc)
set(CMAKE_CXX_COMPILER arm-linux-gnueabihf-g++)
# Debian's armhf: ARMv7-A with VFPv3-D16; its vmul/vadd/vsqrt in double precision round as IEEE 754 says.
set(CMAKE_CXX_FLAGS_INIT "-Wno-psabi")
set(CMAKE_CROSSCOMPILING_EMULATOR qemu-arm;-L;/usr/arm-linux-gnueabihf)

# Libraries and programs of the host are not the board's. Header-only packages (Eigen) are.
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
