# SPDX-License-Identifier: Apache-2.0
# Debian's cross compiler for armhf, for processors with NEON: every ARMv7 board that a robot is likely to have, but not all
# that Debian's armhf serves. Its integer vectors take more than half of a frame's instructions away and give the same bits.
# Packages: as armhf.cmake.
include(${CMAKE_CURRENT_LIST_DIR}/armhf.cmake)
string(APPEND CMAKE_CXX_FLAGS_INIT " -mfpu=neon-vfpv4")
