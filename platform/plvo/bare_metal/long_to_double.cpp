// SPDX-License-Identifier: Apache-2.0
// What the compiler calls to make a double of a 64-bit integer. Its own library has it in one piece with the
// sums of processors without floating point, ten times as long. Exact but for the one rounding of the sum, as
// there.
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
