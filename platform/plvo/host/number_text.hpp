// SPDX-License-Identifier: Apache-2.0
// Numbers as text.
#pragma once

#include <charconv>
#include <string_view>
#include <system_error>

namespace plvo {

// Reads the whole text as one number, with a decimal point in every locale and without a plus sign. Returns
// false for any other text and for a number that the type cannot hold; the value stays as it was.
template <typename Number>
bool parse_whole_text(std::string_view text, Number& value) {
  Number number{};
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, number);
  if (error != std::errc() || stop != end) return false;
  value = number;
  return true;
}

}  // namespace plvo
