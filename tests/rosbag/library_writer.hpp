// SPDX-License-Identifier: Apache-2.0
// Writes bags with ROS's own library, which the reader does not use. This verifies that both implement the
// same format.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace plvo::test {

struct RecordedMessage {
  std::string topic, type, data;
  std::int64_t received_ns = 0;
};

// compression: none, bz2 or lz4. On failure returns false, with the reason in `error`.
bool write_bag_with_library(const std::string& path, const std::string& compression,
                            const std::vector<RecordedMessage>& messages, std::string& error);

}  // namespace plvo::test
