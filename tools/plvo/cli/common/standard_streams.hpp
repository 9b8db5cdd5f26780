// SPDX-License-Identifier: Apache-2.0
// Standard output as a place for data: what cannot be written there is an error like that of any file.
#pragma once

#include <string_view>

#include "plvo/base/status.hpp"

namespace plvo::cli {

// Descriptors 0 to 2 that the caller closed are taken, so that no file that is opened later gets one of them
// and messages into its data. Writing to them fails.
void hold_standard_streams();

// Writes and flushes. kIo with the operating system's reason.
Status print(std::string_view text);

}  // namespace plvo::cli
