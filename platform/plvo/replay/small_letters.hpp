// SPDX-License-Identifier: Apache-2.0
// Lower case for comparing names without regard to case (ASCII).
#pragma once

#include <string>
#include <string_view>

namespace plvo {

inline std::string in_small_letters(std::string_view name) {
  std::string text(name);
  for (char& c : text) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return text;
}

}  // namespace plvo
