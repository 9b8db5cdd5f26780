// SPDX-License-Identifier: Apache-2.0
// What a TUM folder offers: rgb.txt and depth.txt (`stamp file` per line, `#` comments), or one associations
// file (`stamp rgb stamp depth`, or depth first where the names say so). The two lists become pairs by
// nearest stamps: see stamp_pairs.hpp. A name may hold spaces if it ends as images do (ends_as_image).
#pragma once

#include <cstdint>
#include <filesystem>

#include "plvo/base/status.hpp"
#include "plvo/replay/index/sequence_index.hpp"

namespace plvo {

// Reads folder/rgb.txt and folder/depth.txt, or, when `associations` names a file or the folder has no
// rgb.txt but an associations.txt, that file. tolerance_ns: the largest difference of stamps in a pair.
// kNotFound for a missing list; kDamaged, naming file and line, for a line that is not understood
// or stamps that do not increase; kInvalidArgument when nothing pairs up, or a list is no regular file.
Status read_tum_index(const std::filesystem::path& folder, const std::filesystem::path& associations,
                      std::int64_t tolerance_ns, SequenceIndex& index);

}  // namespace plvo
