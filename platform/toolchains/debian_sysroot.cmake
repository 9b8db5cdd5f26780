# SPDX-License-Identifier: Apache-2.0
# Included by the boards' files: Debian's cross compiler `triplet` against a folder of the board's own Debian packages
# (tools/setup/board.sh fills build/sysroot-<architecture>); what is built runs under qemu's user-mode emulation.
get_filename_component(sysroot ${CMAKE_CURRENT_LIST_DIR}/../../build/sysroot-${debian_architecture} ABSOLUTE)
if(NOT EXISTS ${sysroot}/usr/include/stdlib.h)
  message(FATAL_ERROR "no board packages at ${sysroot}: run tools/setup/board.sh first")
endif()
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_C_COMPILER ${triplet}-gcc)
set(CMAKE_CXX_COMPILER ${triplet}-g++)
set(CMAKE_LIBRARY_ARCHITECTURE ${triplet})
set(CMAKE_SYSROOT ${sysroot})
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)

# pkg-config: the board's files, and their paths below the sysroot.
set(ENV{PKG_CONFIG_SYSROOT_DIR} ${sysroot})
set(ENV{PKG_CONFIG_LIBDIR} ${sysroot}/usr/lib/${triplet}/pkgconfig:${sysroot}/usr/share/pkgconfig)
set(CMAKE_CROSSCOMPILING_EMULATOR ${emulator};-L;${sysroot})
