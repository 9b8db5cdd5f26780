// SPDX-License-Identifier: Apache-2.0
// A line of text built from words and whole numbers, without printf and without a heap: what a board without
// an operating system prints. Text beyond the capacity is left out.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace plvo {

class TextLine {
 public:
  TextLine& text(std::string_view words) {
    for (char c : words) put(c);
    return *this;
  }
  TextLine& space() { return text(" "); }
  TextLine& integer(std::int64_t value) {
    if (value < 0) put('-');
    std::uint64_t rest =
        value < 0 ? ~static_cast<std::uint64_t>(value) + 1 : static_cast<std::uint64_t>(value);
    char digits[20];
    std::size_t n = 0;
    do {
      digits[n++] = static_cast<char>('0' + rest % 10);
      rest /= 10;
    } while (rest != 0);
    while (n > 0) put(digits[--n]);
    return *this;
  }
  TextLine& hex(std::uint64_t value, int digits) {
    for (int i = digits - 1; i >= 0; --i) put("0123456789abcdef"[(value >> (4 * i)) & 0xf]);
    return *this;
  }
  std::string_view view() const { return {characters_, size_}; }

 private:
  void put(char c) {
    if (size_ < sizeof characters_) characters_[size_++] = c;
  }

  char characters_[240];
  std::size_t size_ = 0;
};

}  // namespace plvo
