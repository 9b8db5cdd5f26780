# SPDX-License-Identifier: Apache-2.0
# What every target of plvo shares: the warnings, and the switches that make the arithmetic the same on every
# processor. The switches belong to this directory and those below it: whoever links plvo keeps his own.

add_library(plvo_warnings INTERFACE)
target_compile_options(plvo_warnings INTERFACE
  -Wall -Wextra -Wconversion -Wshadow -Wnon-virtual-dtor $<$<BOOL:${PLVO_WERROR}>:-Werror>)

# No fused multiply-add and no width-dependent vector sums: the same bits on x86-64, aarch64 and armhf. Loops in place of
# code that Eigen writes out (math/rolled_loops.hpp), and, where the build type says so, bytes of code before time
# (base/build.hpp): templates must be the same in all files that are linked together, so they all see both.
add_compile_options(-ffp-contract=off)
add_compile_definitions(EIGEN_DONT_VECTORIZE EIGEN_MPL2_ONLY PLVO_ROLLED_LOOPS $<$<CONFIG:MinSizeRel>:PLVO_SIZE_OPTIMISED>)

find_package(Eigen3 3.3 REQUIRED NO_MODULE)
# The order of the sums within Eigen's functions is part of the bits: tests/golden/golden.txt was written with this one.
set(PLVO_GOLDEN_EIGEN 3.4.0)
if(NOT Eigen3_VERSION VERSION_EQUAL PLVO_GOLDEN_EIGEN)
  message(STATUS "plvo: Eigen ${Eigen3_VERSION} here, ${PLVO_GOLDEN_EIGEN} where the golden run was made: "
    "golden_test says whether the bits are the same")
endif()

# How the core is compiled. Loops over pixels are vectorised (PLVO_PIXEL_SOURCES); those over the three numbers of a point are
# not: GCC 12 takes two of them together just behind the stores that made them one by one, and every such load waits for
# both. GCC 12's SLP vectoriser turns a product beside a sum and a difference into vfmaddsub where the
# processor has it (-march=native, -mfma), without asking -ffp-contract: it fuses, and the last digit changes. Vectorised
# loops do not do so. architecture_embedding holds this.
set(PLVO_CORE_OPTIONS -fno-exceptions -fno-rtti -fno-threadsafe-statics -fno-math-errno
  $<$<CXX_COMPILER_ID:GNU>:-fno-tree-slp-vectorize$<SEMICOLON>-fno-tree-vectorize>)
set(PLVO_CORE_PRECOMPILED <algorithm> <array> <limits> <span> <Eigen/Core>)

# plvo_precompile(<target> PRIVATE <header>… | REUSE_FROM <target>): read these headers once for all files of the target.
# Where ccache launches the compiler they are left out: it would keep nothing then, and files that forget an include are
# found.
function(plvo_precompile target)
  if(NOT CMAKE_CXX_COMPILER_LAUNCHER MATCHES "ccache")
    target_precompile_headers(${target} ${ARGN})
  endif()
endfunction()

# plvo_public_headers(<header>…): what this module of core or hal gives to those who install plvo. The lists together must
# hold what odometry/odometry.hpp, inertial/imu_integrator.hpp and hal/ include, and nothing else; architecture_install says what
# is missing or too much.
function(plvo_public_headers)
  foreach(header ${ARGN})
    set_property(GLOBAL APPEND PROPERTY PLVO_PUBLIC_HEADERS ${CMAKE_CURRENT_SOURCE_DIR}/${header})
  endforeach()
endfunction()

# plvo_seal(<archive target>): the archive keeps its copies of inline functions and templates for itself. Otherwise the
# linker would keep one copy of a function that both the core and its user have compiled, perhaps the user's, with the
# user's switches, and the core's bits would depend on them. It is done where plvo is part of another project, and to what is
# installed (install.cmake); plvo's own programs are compiled with the core's switches anyway. Builds with sanitizers or
# link-time optimisation stay open: their objects hold more than code, and nobody installs them.
function(plvo_seal target)
  if(PROJECT_IS_TOP_LEVEL OR CMAKE_CXX_FLAGS MATCHES "-fsanitize|-flto" OR CMAKE_INTERPROCEDURAL_OPTIMIZATION)
    return()
  endif()
  add_custom_command(TARGET ${target} POST_BUILD VERBATIM COMMAND ${CMAKE_COMMAND} -DARCHIVE=$<TARGET_FILE:${target}>
    -DCXX=${CMAKE_CXX_COMPILER} "-DFLAGS=${CMAKE_CXX_FLAGS}" -DNM=${CMAKE_NM} -DOBJCOPY=${CMAKE_OBJCOPY} -DAR=${CMAKE_AR}
    -P ${PROJECT_SOURCE_DIR}/tools/cmake/seal_archive.cmake)
endfunction()

# plvo_core_features(<core target> both|points|lines): the kinds of features that it holds.
function(plvo_core_features target features)
  if(features STREQUAL points)
    target_compile_definitions(${target} PRIVATE PLVO_WITHOUT_LINES)
  elseif(features STREQUAL lines)
    target_compile_definitions(${target} PRIVATE PLVO_WITHOUT_POINTS)
  elseif(NOT features STREQUAL both)
    message(FATAL_ERROR "PLVO_FEATURES is '${features}': both, points or lines?")
  endif()
endfunction()

# plvo_core_variant(<name> <options…>): the core once more, compiled another way, for tests that compare or watch it.
# Options come after those of the build type, so the last optimisation level counts.
function(plvo_core_variant name)
  get_target_property(sources plvo_core PLVO_SOURCES)
  add_library(${name} STATIC ${sources})
  set_target_properties(${name} PROPERTIES UNITY_BUILD_BATCH_SIZE 0)
  target_link_libraries(${name} PUBLIC Eigen3::Eigen)
  target_include_directories(${name} PUBLIC ${PROJECT_SOURCE_DIR}/core)
  target_compile_options(${name} PRIVATE ${PLVO_CORE_OPTIONS} ${ARGN})
  plvo_precompile(${name} PRIVATE ${PLVO_CORE_PRECOMPILED})
endfunction()
