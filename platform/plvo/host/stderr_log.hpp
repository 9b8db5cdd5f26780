// SPDX-License-Identifier: Apache-2.0
// Messages to standard error, one line each, whole lines even from several threads.
#pragma once

#include "plvo/hal/log.hpp"

namespace plvo {

class StderrLog final : public Log {
 public:
  void write(LogLevel level, std::string_view message) override;
};

}  // namespace plvo
