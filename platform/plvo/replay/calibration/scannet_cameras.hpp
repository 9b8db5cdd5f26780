// SPDX-License-Identifier: Apache-2.0
// The two cameras of what was exported of ScanNet's .sens: 4×4 matrices in the folder intrinsic,
// intrinsic_color.txt and intrinsic_depth.txt, in pixels of either image, and, optional, extrinsic_color.txt
// and extrinsic_depth.txt. An extrinsic maps from its camera to the frame that both share, which ScanNet's
// own programs have in the colour camera.
#pragma once

#include <filesystem>
#include <vector>

#include "plvo/base/status.hpp"
#include "plvo/replay/calibration/calibration.hpp"

namespace plvo {

// Those of the files that are there.
std::vector<std::filesystem::path> scannet_camera_files(const std::filesystem::path& folder);

// Both intrinsics are there.
bool has_scannet_cameras(const std::filesystem::path& folder);

// Colour's camera, and depth's as one of its own. As read_calibration and read_matrix_pose.
Status read_scannet_cameras(const std::filesystem::path& folder, Calibration& calibration);

}  // namespace plvo
