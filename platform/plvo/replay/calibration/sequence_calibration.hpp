// SPDX-License-Identifier: Apache-2.0
// The calibration of a recorded sequence about which the user says nothing.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "plvo/base/status.hpp"
#include "plvo/replay/calibration/calibration.hpp"

namespace plvo {

// The file beside the images (calibration_file_in); where that is one of ScanNet's, and colour and depth have
// sizes of their own, both its cameras (read_scannet_cameras). Without a file, the TUM camera that the
// folder's name speaks of (rgbd_dataset_freiburg1_xyz, fr2_desk): a guess, which `guess` then puts in words.
// kNotFound when neither helps, or as read_calibration.
Status sequence_calibration(const std::filesystem::path& folder, Calibration& calibration,
                            std::string& guess);

// Which files of the folder say it.
std::vector<std::filesystem::path> calibration_files_in(const std::filesystem::path& folder);

}  // namespace plvo
