// SPDX-License-Identifier: Apache-2.0
// What is wrong with the stamps of a list, or of two lists against each other.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace plvo {

struct StampFault {
  enum class Kind : std::uint8_t {
    kRepeated,   // a stamp is there twice
    kUnsorted,   // the list is not in the order of time
    kClockStep,  // the list is, but its clock was set back: sorting would mix what came before and after
  };
  Kind kind = Kind::kUnsorted;
  std::size_t at = 0;        // the first stamp that is not later than the one before
  std::int64_t step_ns = 0;  // by so much a clock was set back
};

// Nothing where the stamps increase. A clock was set back where the order of the list is the more even one:
// sorted, steps would become shorter or gaps come up.
std::optional<StampFault> find_stamp_fault(const std::vector<std::int64_t>& stamps_ns);

// "stamp … runs backwards; …", with the remedy.
std::string in_words(const StampFault& fault, const std::vector<std::int64_t>& stamps_ns);

// By how much the clock of the second list is ahead of the first one's, where both ends of the lists say the
// same: they begin and end equally far apart, by more than one and a half steps. Both strictly increasing.
std::optional<std::int64_t> clock_offset_ns(const std::vector<std::int64_t>& first,
                                            const std::vector<std::int64_t>& second);

// Why no two images are within the tolerance, as far as their stamps tell. Neither list is empty.
std::string why_no_pair(const std::vector<std::int64_t>& colour, const std::vector<std::int64_t>& depth);

// What looks wrong about lists that pair up: another unit than seconds, or two clocks; else empty.
std::string doubt_about_clocks(const std::vector<std::int64_t>& colour,
                               const std::vector<std::int64_t>& depth);

}  // namespace plvo
