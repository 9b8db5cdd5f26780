// SPDX-License-Identifier: Apache-2.0
// Reads the lists of a TUM folder: rgb.txt and depth.txt (`stamp file` per line, `#` comments), or one
// associations file (`stamp rgb stamp depth`, or depth first if the names show it). Nearest stamps of the two
// lists become pairs: see stamp_pairs.hpp. A name may contain spaces if it has the ending of an image
// (ends_as_image).
#pragma once

#include <cstdint>
#include <filesystem>

#include "plvo/base/status.hpp"
#include "plvo/replay/index/sequence_index.hpp"

namespace plvo {

// Reads folder/rgb.txt and folder/depth.txt. Reads an associations file instead if `associations` names one,
// or if the folder has no rgb.txt but an associations.txt. tolerance_ns: the largest difference of stamps in
// a pair. Returns kNotFound for a missing list; kDamaged, naming file and line, for a line that cannot be
// parsed or stamps that do not increase; kInvalidArgument if there are no pairs, or a list is not a regular
// file.
Status read_tum_index(const std::filesystem::path& folder, const std::filesystem::path& associations,
                      std::int64_t tolerance_ns, SequenceIndex& index);

}  // namespace plvo
