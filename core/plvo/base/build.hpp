// SPDX-License-Identifier: Apache-2.0
// The options of this build, as constants. The compiler still checks disabled code, but it does not keep it.
// CMake sets the options: the kinds of features for the core's own sources only (PLVO_FEATURES), size
// optimisation for everything in that build type, because templates in headers depend on it.
#pragma once

namespace plvo {

// Kinds of features in this build. A kind that is not built has no matches, and Config::validate rejects a
// configuration that requests it.
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

// Size-optimised code: computes values instead of reading them from a table. The results are the same.
#ifdef PLVO_SIZE_OPTIMISED
inline constexpr bool kSizeOptimised = true;
#else
inline constexpr bool kSizeOptimised = false;
#endif

// SIMD vectors (base/simd.hpp) are plain loops, and algorithms use their scalar version. This holds for
// size-optimised code, and for processors without SIMD registers, where compilers would expand each operation
// lane by lane. The results are the same.
#if defined(PLVO_SIZE_OPTIMISED) || !(defined(__SSE2__) || defined(__ARM_NEON))
#define PLVO_SIMD_LOOPS
inline constexpr bool kSimdLoops = true;
#else
inline constexpr bool kSimdLoops = false;
#endif

}  // namespace plvo
