// SPDX-License-Identifier: Apache-2.0
// Detects recordings in containers that plvo does not read, by their names and their first bytes.
#pragma once

#include <filesystem>

#include "plvo/base/status.hpp"

namespace plvo {

// Returns kUnsupported, with the format and the remedy, for Matroska videos. Returns ok for everything else.
Status refuse_foreign_format(const std::filesystem::path& path);

}  // namespace plvo
