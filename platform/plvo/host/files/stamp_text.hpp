// SPDX-License-Identifier: Apache-2.0
// Time stamps as text. Files write seconds with decimals; plvo counts nanoseconds in integers. A double
// cannot hold both the seconds since 1970 and the nanoseconds, so the digits are read one by one.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace plvo {

// Seconds ("1305031102.175304", also with an exponent) to nanoseconds. False for anything that is not such a
// number or lies beyond ±292 years; decimals beyond the ninth are cut off.
bool parse_stamp_ns(std::string_view seconds, std::int64_t& stamp_ns);

// Why parse_stamp_ns refused the word: it is no number, or has too many digits for seconds and looks like
// milliseconds, microseconds or nanoseconds.
std::string stamp_error(std::string_view word);

// Stamps of images or poses, in their order. Returns a message if their median step is longer than 3 s, so
// that their unit seems not to be seconds; else an empty string.
std::string stamp_unit_doubt(const std::vector<std::int64_t>& stamps_ns);

// The median of the steps forward; 0 without one.
std::int64_t median_step_ns(const std::vector<std::int64_t>& stamps_ns);

// Seconds with six decimals, or nine where the stamp has nanoseconds.
std::string format_stamp(std::int64_t stamp_ns);

}  // namespace plvo
