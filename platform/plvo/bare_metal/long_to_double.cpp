// SPDX-License-Identifier: Apache-2.0
// The functions that the compiler calls to convert a 64-bit integer to double. The compiler's own library
// links them together with the software addition for processors without floating point, which is ten times as
// large. The result is exact except for one rounding of the sum, as in that library.
#include <cstdint>

extern "C" {

[[gnu::pcs("aapcs")]] double __aeabi_l2d(std::int64_t value) {
  return static_cast<double>(static_cast<std::int32_t>(value >> 32)) * 4294967296.0 +
         static_cast<double>(static_cast<std::uint32_t>(value));
}

[[gnu::pcs("aapcs")]] double __aeabi_ul2d(std::uint64_t value) {
  return static_cast<double>(static_cast<std::uint32_t>(value >> 32)) * 4294967296.0 +
         static_cast<double>(static_cast<std::uint32_t>(value));
}

}  // extern "C"
