// SPDX-License-Identifier: Apache-2.0
// The options of this build, as constants. The compiler still checks disabled code, but it does not keep it.
// CMake sets PLVO_SIZE_OPTIMISED for everything in that build type, because templates in headers depend on
// it.
#pragma once

namespace plvo {

// Size-optimised code: computes values instead of reading them from a table. The results are the same.
#ifdef PLVO_SIZE_OPTIMISED
inline constexpr bool kSizeOptimised = true;
#else
inline constexpr bool kSizeOptimised = false;
#endif

// SIMD vectors (base/simd.hpp) are plain loops, and algorithms use their scalar version. This holds for
// size-optimised code, and for processors without SIMD registers, where compilers would expand each operation
// element by element. The results are the same.
#if defined(PLVO_SIZE_OPTIMISED) || !(defined(__SSE2__) || defined(__ARM_NEON))
#define PLVO_SIMD_LOOPS
inline constexpr bool kSimdLoops = true;
#else
inline constexpr bool kSimdLoops = false;
#endif

}  // namespace plvo
