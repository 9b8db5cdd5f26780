// SPDX-License-Identifier: Apache-2.0
// Parts of error messages about topics.
#pragma once

#include <fmt/core.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "plvo/base/status.hpp"
#include "plvo/host/files/stamp_text.hpp"

namespace plvo {

// Lists names as "/a, /b and 3 more": as many as fit into most_letters, because a status is short, but at
// least one.
inline std::string listed(const std::vector<std::string>& names,
                          std::size_t most_letters = static_cast<std::size_t>(-1)) {
  std::string text;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (i > 0 && text.size() + names[i].size() > most_letters)
      return text + " and " + std::to_string(names.size() - i) + " more";
    text += (i == 0 ? "" : ", ") + names[i];
  }
  return text;
}

// Error for a topic whose headers all have one stamp: its messages have no order.
inline Status not_stamped(const char* what, std::size_t count, const std::string& topic,
                          std::int64_t stamp_ns) {
  return {StatusCode::kInvalidArgument,
          fmt::format("all {} {} on {} have the stamp {} in their headers: the driver does not stamp them; "
                      "give each its time of receipt (share/doc/plvo/user/ros_recordings.md)",
                      count, what, topic, stamp_ns == 0 ? "0" : format_stamp(stamp_ns))};
}

}  // namespace plvo
