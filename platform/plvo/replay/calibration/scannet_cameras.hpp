// SPDX-License-Identifier: Apache-2.0
// Reads the two cameras of an export of ScanNet's .sens: 4×4 matrices in the folder intrinsic.
// intrinsic_color.txt and intrinsic_depth.txt are in pixels of their own image; extrinsic_color.txt and
// extrinsic_depth.txt are optional. An extrinsic maps from its camera to a common frame, which ScanNet's own
// programs place in the colour camera.
#pragma once

#include <filesystem>
#include <vector>

#include "plvo/base/status.hpp"
#include "plvo/replay/calibration/calibration.hpp"

namespace plvo {

// The files that exist.
std::vector<std::filesystem::path> scannet_camera_files(const std::filesystem::path& folder);

// Whether both intrinsics exist.
bool has_scannet_cameras(const std::filesystem::path& folder);

// Reads the colour camera, and the depth camera as a separate one. Returns the errors of read_calibration and
// read_matrix_pose.
Status read_scannet_cameras(const std::filesystem::path& folder, Calibration& calibration);

}  // namespace plvo
