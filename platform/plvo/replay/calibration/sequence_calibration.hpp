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
// sizes of their own, both its cameras (read_scannet_cameras). Without one, the folder's only YAML or JSON
// file, if it is a calibration; else, where the folder has the name of one of TUM's recordings
// (rgbd_dataset_freiburg1_xyz), TUM's camera: guesses, which `guess` then puts in words. kNotFound, with what
// a name that only looks like TUM's hints at, when none helps, or as read_calibration.
Status sequence_calibration(const std::filesystem::path& folder, Calibration& calibration,
                            std::string& guess);

// What TUM's named cameras say and this calibration does not, in a sentence, where the recording's name or
// the calibration's numbers (of the whole images) say that it is one of them; else empty.
std::string missing_of_tum(const std::filesystem::path& recording, const Calibration& calibration);

// Which files of the folder say it.
std::vector<std::filesystem::path> calibration_files_in(const std::filesystem::path& folder);

}  // namespace plvo
