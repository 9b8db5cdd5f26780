# SPDX-License-Identifier: Apache-2.0
# Debian's cross compiler for a Cortex-M7 with double-precision floating point and no operating system; what it builds runs
# under qemu's emulated board. Only headers are taken from the C and C++ libraries: nothing of them is linked.
# Packages: gcc-arm-none-eabi libnewlib-arm-none-eabi libstdc++-arm-none-eabi-newlib qemu-system-arm.
set(CMAKE_SYSTEM_NAME Generic)
set(CMAKE_SYSTEM_PROCESSOR cortex-m7)
set(CMAKE_C_COMPILER arm-none-eabi-gcc)
set(CMAKE_CXX_COMPILER arm-none-eabi-g++)
set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)

set(cortex_m7_flags "-mcpu=cortex-m7 -mfpu=fpv5-d16 -mfloat-abi=hard -mthumb -ffunction-sections -fdata-sections -Wno-psabi")
set(CMAKE_C_FLAGS_INIT "${cortex_m7_flags}")
set(CMAKE_CXX_FLAGS_INIT "${cortex_m7_flags} -fno-exceptions -fno-rtti -fno-threadsafe-statics -fno-use-cxa-atexit")
set(CMAKE_EXE_LINKER_FLAGS_INIT "-nostdlib -nostartfiles -Wl,--gc-sections")
set(CMAKE_CROSSCOMPILING_EMULATOR
  qemu-system-arm;-M;mps2-an500;-nographic;-monitor;none;-serial;none;-semihosting-config;enable=on,target=native;-kernel)

# Header-only packages (Eigen) are the host's.
set(CMAKE_PREFIX_PATH /usr)
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
