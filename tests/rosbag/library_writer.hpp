// SPDX-License-Identifier: Apache-2.0
// Bags by ROS's own library, which the reader does not use: that both mean the same format is then not a
// matter of opinion.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace plvo::test {

struct RecordedMessage {
  std::string topic, type, data;
  std::int64_t received_ns = 0;
};

// compression: none, bz2 or lz4. False, and why in `error`, where the library refuses.
bool write_bag_with_library(const std::string& path, const std::string& compression,
                            const std::vector<RecordedMessage>& messages, std::string& error);

}  // namespace plvo::test
