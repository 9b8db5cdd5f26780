// SPDX-License-Identifier: Apache-2.0
// The calibration of a recorded sequence for which the user gives none.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "plvo/base/status.hpp"
#include "plvo/replay/calibration/calibration.hpp"

namespace plvo {

// Takes the file beside the images (calibration_file_in); if it is one of ScanNet's, and colour and depth
// differ in size, both its cameras (read_scannet_cameras). Without one, it guesses and puts the guess into
// `guess`: the folder's only YAML or JSON file, if that is a calibration; else TUM's camera, if the folder
// has the name of one of TUM's recordings (rgbd_dataset_freiburg1_xyz). Returns kNotFound if all fail, with a
// hint if the name resembles TUM's; else the status of read_calibration.
Status sequence_calibration(const std::filesystem::path& folder, Calibration& calibration,
                            std::string& guess);

// Describes what TUM's named cameras have and this calibration lacks, if the recording's name or the
// calibration's numbers (of the whole images) identify one of them; else empty.
std::string missing_of_tum(const std::filesystem::path& recording, const Calibration& calibration);

// The calibration files of the folder.
std::vector<std::filesystem::path> calibration_files_in(const std::filesystem::path& folder);

}  // namespace plvo
