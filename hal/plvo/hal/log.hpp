// SPDX-License-Identifier: Apache-2.0
// Where messages go. The text is borrowed for the call only.
#pragma once

#include <cstdint>
#include <string_view>

namespace plvo {

enum class LogLevel : std::uint8_t { kInfo, kWarning, kError };

class Log {
 public:
  virtual ~Log() = default;
  virtual void write(LogLevel level, std::string_view message) = 0;
};

}  // namespace plvo
