// SPDX-License-Identifier: Apache-2.0
// Where messages go. The text is borrowed for the call only.
#pragma once

#include <cstdint>
#include <string_view>

namespace plvo {

enum class LogLevel : std::uint8_t { kInfo, kWarning, kError };

class Log {
 public:
  virtual void write(LogLevel level, std::string_view message) = 0;

 protected:
  // Never deleted through the interface: a virtual destructor would ask every board for operator delete.
  ~Log() = default;
};

}  // namespace plvo
