// SPDX-License-Identifier: Apache-2.0
// Reads the files of `plvo run --covariance` and `--motions` (docs/user/outputs.md), or those of another
// system: a covariance is 36 numbers, row-major, or the 21 of its upper triangle.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "plvo/base/status.hpp"
#include "plvo/math/se3.hpp"

namespace plvo::eval {

struct StampedCovariance {
  std::int64_t stamp_ns = 0;
  Matrix6 covariance;
};

struct UncertainMotion {
  std::int64_t stamp_ns = 0;
  std::int64_t reference_stamp_ns = 0;
  Se3 T_camera_reference;
  Matrix6 covariance;
};

// Sorted by stamp. Returns the errors of read_text_file, and kDamaged with file and line.
Status read_covariances(const std::filesystem::path& path, std::vector<StampedCovariance>& covariances);
Status read_motions(const std::filesystem::path& path, std::vector<UncertainMotion>& motions);

}  // namespace plvo::eval
