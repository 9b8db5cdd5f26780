// SPDX-License-Identifier: Apache-2.0
#include "plvo/host/printable.hpp"

#include <fmt/format.h>

#include <cstdint>
#include <iterator>

namespace plvo {
namespace {

struct Character {
  char32_t code = 0;
  std::size_t bytes = 0;  // 0: the text does not begin with a character of UTF-8
};

// The first character of a text that is not empty (RFC 3629: the shortest form, no surrogates, no more than
// U+10FFFF).
Character first_character(std::string_view text) {
  const auto byte = [&text](std::size_t i) { return static_cast<std::uint8_t>(text[i]); };
  if (byte(0) < 0x80) return {byte(0), 1};
  const std::size_t bytes = byte(0) >= 0xf0 ? 4 : byte(0) >= 0xe0 ? 3 : 2;
  if (byte(0) < 0xc2 || byte(0) > 0xf4 || text.size() < bytes) return {};
  char32_t code = byte(0) & (0x7fU >> bytes);
  for (std::size_t i = 1; i < bytes; ++i) {
    if ((byte(i) & 0xc0U) != 0x80) return {};
    code = code << 6 | (byte(i) & 0x3fU);
  }
  const bool shortest = bytes < 3 || code >= (bytes == 3 ? 0x800U : 0x10000U);
  const bool surrogate = code >= 0xd800 && code <= 0xdfff;
  return shortest && !surrogate && code <= 0x10ffff ? Character{code, bytes} : Character{};
}

bool between(char32_t code, char32_t first, char32_t last) { return code >= first && code <= last; }

bool is_shown(char32_t code) {
  const bool control = code < 0x20 || between(code, 0x7f, 0x9f);
  const bool turns_text = code == 0x61c || between(code, 0x200e, 0x200f) || between(code, 0x202a, 0x202e) ||
                          between(code, 0x2066, 0x2069);
  return !control && !turns_text && !between(code, 0x2028, 0x2029);
}

std::string escaped(std::string_view text, bool keep_newlines) {
  std::string out;
  out.reserve(text.size());
  while (!text.empty()) {
    const Character first = first_character(text);
    const std::string_view bytes = text.substr(0, first.bytes == 0 ? 1 : first.bytes);
    text.remove_prefix(bytes.size());
    if (first.bytes != 0 && (is_shown(first.code) || (keep_newlines && first.code == '\n'))) {
      out += bytes;
    } else if (bytes == "\n" || bytes == "\t") {
      out += bytes == "\n" ? "\\n" : "\\t";
    } else if (bytes.size() == 1) {
      fmt::format_to(std::back_inserter(out), "\\x{:02x}", static_cast<std::uint8_t>(bytes[0]));
    } else {
      fmt::format_to(std::back_inserter(out), "\\u{:04x}", static_cast<std::uint32_t>(first.code));
    }
  }
  return out;
}

}  // namespace

std::string printable(std::string_view text) { return escaped(text, false); }
std::string printable_lines(std::string_view text) { return escaped(text, true); }

}  // namespace plvo
