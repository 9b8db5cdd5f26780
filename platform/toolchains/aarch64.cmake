# SPDX-License-Identifier: Apache-2.0
# Debian's cross compiler for aarch64; the tests run under qemu's user-mode emulation.
# Packages: g++-aarch64-linux-gnu qemu-user (and googletest for the tests).
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(CMAKE_C_COMPILER aarch64-linux-gnu-gcc)
set(CMAKE_CXX_COMPILER aarch64-linux-gnu-g++)
set(CMAKE_CROSSCOMPILING_EMULATOR qemu-aarch64;-L;/usr/aarch64-linux-gnu)

# Libraries and programs of the host are not the board's. Header-only packages (Eigen) are.
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
