// SPDX-License-Identifier: Apache-2.0
// The calibration of a recorded sequence about which the user says nothing.
#pragma once

#include <filesystem>
#include <string>

#include "plvo/base/status.hpp"
#include "plvo/replay/calibration.hpp"

namespace plvo {

// The file beside the images (calibration_file_in); without one, the TUM camera that the folder's name speaks
// of (rgbd_dataset_freiburg1_xyz, fr2_desk): a guess, which `guess` then puts in words. kNotFound when
// neither helps, or as read_calibration.
Status sequence_calibration(const std::filesystem::path& folder, Calibration& calibration,
                            std::string& guess);

}  // namespace plvo
