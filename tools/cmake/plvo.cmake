# SPDX-License-Identifier: Apache-2.0
# Settings that all targets of plvo share: the warnings, and the options that make the arithmetic identical on every
# processor. The options apply to this directory and its subdirectories only; a project that links plvo keeps its own.

add_library(plvo_warnings INTERFACE)
target_compile_options(plvo_warnings INTERFACE
  -Wall -Wextra -Wconversion -Wshadow -Wnon-virtual-dtor $<$<BOOL:${PLVO_WERROR}>:-Werror>)

# Without fused multiply-add and sums that depend on the vector width, x86-64, aarch64 and armhf give the same bits.
# The definitions of the build for size apply to all files, since a template must be identical in all files that are linked
# together: PLVO_SIZE_OPTIMISED prefers code size to speed (base/build.hpp); EIGEN_UNROLLING_LIMIT, which Eigen's documentation
# describes, keeps it from unrolling assignments of more than a few entries. Eigen adds in another order in a loop, so the limit is
# above the cost of every sum in the core: the longest one, of seven products, costs 27. A costlier one is written as a sum of
# shorter ones, or of values that are evaluated first.
set(PLVO_SIZE_DEFINITIONS PLVO_SIZE_OPTIMISED EIGEN_UNROLLING_LIMIT=28)
add_compile_options(-ffp-contract=off)
add_compile_definitions(EIGEN_DONT_VECTORIZE EIGEN_MPL2_ONLY "$<$<CONFIG:MinSizeRel>:${PLVO_SIZE_DEFINITIONS}>")

find_package(Eigen3 3.3 REQUIRED NO_MODULE)
# The order of the sums inside Eigen's functions affects the bits: tests/golden/golden.txt was written with this version.
set(PLVO_GOLDEN_EIGEN 3.4.0)
if(NOT Eigen3_VERSION VERSION_EQUAL PLVO_GOLDEN_EIGEN)
  message(STATUS "plvo: Eigen ${Eigen3_VERSION} here, ${PLVO_GOLDEN_EIGEN} where the golden run was made: "
    "golden_test says whether the bits are the same")
endif()

# Compiler options of the core. Loops over pixels are vectorised (plvo_vectorise in core/CMakeLists.txt). Loops over the three coordinates of a
# point are not: GCC 12 loads two of them together immediately after it has stored them one by one, and every such load waits
# for both stores. GCC 12's SLP vectoriser also turns a product next to a sum and a difference into vfmaddsub if the
# processor has it (-march=native, -mfma), in spite of -ffp-contract=off; this fuses the operations and changes the last
# digit. Loop vectorisation does not do so. architecture_embedding tests this.
set(PLVO_CORE_OPTIONS -fno-exceptions -fno-rtti -fno-threadsafe-statics -fno-math-errno
  $<$<CXX_COMPILER_ID:GNU>:-fno-tree-slp-vectorize$<SEMICOLON>-fno-tree-vectorize>)
set(PLVO_CORE_PRECOMPILED <algorithm> <array> <limits> <span> <Eigen/Core>)

# plvo_precompile(<target> PRIVATE <header>… | REUSE_FROM <target>): reads these headers once for all files of the target. It
# does nothing if ccache launches the compiler: ccache could not cache the results, and such builds detect files with a
# missing include.
function(plvo_precompile target)
  if(NOT CMAKE_CXX_COMPILER_LAUNCHER MATCHES "ccache")
    target_precompile_headers(${target} ${ARGN})
  endif()
endfunction()

# plvo_public_headers(<header>…): the headers of this module of core or hal that are installed. Together, the lists must
# contain exactly the headers that odometry/odometry.hpp, inertial/imu_integrator.hpp and hal/ include; architecture_install
# reports missing and superfluous ones.
function(plvo_public_headers)
  foreach(header ${ARGN})
    set_property(GLOBAL APPEND PROPERTY PLVO_PUBLIC_HEADERS ${CMAKE_CURRENT_SOURCE_DIR}/${header})
  endforeach()
endfunction()

# plvo_seal(<archive target>): makes the archive's copies of inline functions and templates local to it. Otherwise the linker
# would keep one copy of a function that both the core and its user have compiled, perhaps the user's with the user's
# options, and the core's bits would depend on them. It applies if plvo is part of another project, and to the installed
# archive (install.cmake); plvo's own programs are compiled with the core's options anyway. Builds with sanitizers or
# link-time optimisation are not sealed: their objects contain more than code, and they are not installed.
function(plvo_seal target)
  if(PROJECT_IS_TOP_LEVEL OR CMAKE_CXX_FLAGS MATCHES "-fsanitize|-flto" OR CMAKE_INTERPROCEDURAL_OPTIMIZATION)
    return()
  endif()
  add_custom_command(TARGET ${target} POST_BUILD VERBATIM COMMAND ${CMAKE_COMMAND} -DARCHIVE=$<TARGET_FILE:${target}>
    -DCXX=${CMAKE_CXX_COMPILER} "-DFLAGS=${CMAKE_CXX_FLAGS}" -DNM=${CMAKE_NM} -DOBJCOPY=${CMAKE_OBJCOPY} -DAR=${CMAKE_AR}
    -P ${PROJECT_SOURCE_DIR}/tools/cmake/seal_archive.cmake)
endfunction()

# plvo_core_variant(<name> <options…>): a second build of the core with other options, for tests that compare
# it. The options follow those of the build type, so their optimisation level takes effect.
function(plvo_core_variant name)
  get_target_property(sources plvo_core PLVO_SOURCES)
  add_library(${name} STATIC ${sources})
  set_target_properties(${name} PROPERTIES UNITY_BUILD_BATCH_SIZE 0)
  target_link_libraries(${name} PUBLIC Eigen3::Eigen)
  target_include_directories(${name} PUBLIC ${PROJECT_SOURCE_DIR}/core)
  target_compile_options(${name} PRIVATE ${PLVO_CORE_OPTIONS} ${ARGN})
  plvo_precompile(${name} PRIVATE ${PLVO_CORE_PRECOMPILED})
endfunction()
