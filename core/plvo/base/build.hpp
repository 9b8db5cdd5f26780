// SPDX-License-Identifier: Apache-2.0
// What this build of the core holds, as constants: what they rule out is compiled, but not kept. CMake sets
// them: the kinds of features for the core's own sources alone (PLVO_FEATURES), small code for all that is
// built with them (its build type), since templates of headers ask for it.
#pragma once

namespace plvo {

// Kinds of features that are built. One that is not has no matches, and Config::validate refuses to ask for
// it.
#ifdef PLVO_WITHOUT_POINTS
inline constexpr bool kPointsBuilt = false;
#else
inline constexpr bool kPointsBuilt = true;
#endif
#ifdef PLVO_WITHOUT_LINES
inline constexpr bool kLinesBuilt = false;
#else
inline constexpr bool kLinesBuilt = true;
#endif

// Bytes of code before time: a computation in place of a table, the result the same.
#ifdef PLVO_SIZE_OPTIMISED
inline constexpr bool kSizeOptimised = true;
#else
inline constexpr bool kSizeOptimised = false;
#endif

// Numbers side by side (base/simd.hpp) are loops, and what is made of them is the plain version: in small
// code, and for a processor without registers for them, for which compilers write out every lane of every
// operation. The result is the same.
#if defined(PLVO_SIZE_OPTIMISED) || !(defined(__SSE2__) || defined(__ARM_NEON))
#define PLVO_SIMD_LOOPS
inline constexpr bool kSimdLoops = true;
#else
inline constexpr bool kSimdLoops = false;
#endif

}  // namespace plvo
