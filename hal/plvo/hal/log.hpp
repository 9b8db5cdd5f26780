// SPDX-License-Identifier: Apache-2.0
// Receives messages. The text is valid only during the call.
#pragma once

#include <cstdint>
#include <string_view>

namespace plvo {

enum class LogLevel : std::uint8_t { kInfo, kWarning, kError };

class Log {
 public:
  virtual void write(LogLevel level, std::string_view message) = 0;

 protected:
  // Never deleted through the interface: a virtual destructor would require operator delete on every board.
  ~Log() = default;
};

}  // namespace plvo
