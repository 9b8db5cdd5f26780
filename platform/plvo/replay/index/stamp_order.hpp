// SPDX-License-Identifier: Apache-2.0
// Finds faults in the stamps of a list, or of two lists against each other.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace plvo {

struct StampFault {
  enum class Kind : std::uint8_t {
    kRepeated,  // a stamp appears twice
    kUnsorted,  // the list is not in order of time
    // The list is in order, but its clock was set back: sorting would mix images from before and after
    kClockStep,
  };
  Kind kind = Kind::kUnsorted;
  std::size_t at = 0;        // the first stamp that is not later than the one before
  std::int64_t step_ns = 0;  // how far a clock was set back
};

// Returns no fault if the stamps increase. A clock was set back if the order of the list is the more even
// one: sorting would shorten steps or create gaps.
std::optional<StampFault> find_stamp_fault(const std::vector<std::int64_t>& stamps_ns);

// Describes the fault: "stamp … runs backwards; …", with the remedy.
std::string in_words(const StampFault& fault, const std::vector<std::int64_t>& stamps_ns);

// Offset of the second list's clock ahead of the first one's. It is found if both ends of the lists agree:
// begins and ends are equally far apart, by more than one and a half steps. Both lists must increase
// strictly.
std::optional<std::int64_t> clock_offset_ns(const std::vector<std::int64_t>& first,
                                            const std::vector<std::int64_t>& second);

// Explains from the stamps why no two images are within the tolerance. Neither list may be empty.
std::string why_no_pair(const std::vector<std::int64_t>& colour, const std::vector<std::int64_t>& depth);

// Describes a doubt about lists that can be paired: a unit other than seconds, or two clocks; else empty.
std::string doubt_about_clocks(const std::vector<std::int64_t>& colour,
                               const std::vector<std::int64_t>& depth);

}  // namespace plvo
