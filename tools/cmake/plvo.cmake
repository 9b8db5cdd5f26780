# SPDX-License-Identifier: Apache-2.0
# What every target of the house shares: the warnings, and the switches that make the
# arithmetic the same on every processor.

add_library(plvo_warnings INTERFACE)
target_compile_options(plvo_warnings INTERFACE
  -Wall -Wextra -Wconversion -Wshadow -Wnon-virtual-dtor -Werror)

# No fused multiply-add and no width-dependent vector sums: the same bits on x86-64, aarch64 and armhf.
add_library(plvo_determinism INTERFACE)
target_compile_options(plvo_determinism INTERFACE -ffp-contract=off)
target_compile_definitions(plvo_determinism INTERFACE EIGEN_DONT_VECTORIZE EIGEN_MPL2_ONLY)

find_package(Eigen3 3.3 REQUIRED NO_MODULE)

# plvo_core_variant(<name> <options…>): the core once more, compiled another way, for tests that compare or watch it.
# Options come after those of the build type, so the last optimisation level counts.
function(plvo_core_variant name)
  get_target_property(sources plvo_core SOURCES)
  get_target_property(source_dir plvo_core SOURCE_DIR)
  list(TRANSFORM sources PREPEND "${source_dir}/" REGEX "^[^/]")
  add_library(${name} STATIC ${sources})
  target_link_libraries(${name} PUBLIC Eigen3::Eigen plvo_determinism)
  target_include_directories(${name} PUBLIC ${PROJECT_SOURCE_DIR}/core)
  target_compile_options(${name} PRIVATE -fno-exceptions -fno-rtti -fno-threadsafe-statics -fno-math-errno ${ARGN})
endfunction()
