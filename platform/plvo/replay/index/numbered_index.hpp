// SPDX-License-Identifier: Apache-2.0
// Reads folders of numbered frames:
//   7-Scenes        frame-000000.color.png  frame-000000.depth.png  frame-000000.pose.txt
//   ScanNet export  color/0.jpg             depth/0.png             pose/0.txt
// and with other common names:
//   two folders     one whose name begins with color, colour, rgb, image or img, one with depth (in any
//                   case); the file names in them contain one number, which is the same for both images
//   one folder      file names with one number and a word: color_0.png and depth_0.png, 0-rgb.png and
//                   0-depth.png …; or without a word 0.jpg and 0.png
// A pose file has the 4×4 matrix T_world_camera. There are no stamps: the stamp of a frame is its number
// divided by the frame rate, so that missing numbers are gaps in time.
#pragma once

#include <filesystem>
#include <vector>

#include "plvo/base/status.hpp"
#include "plvo/replay/index/sequence_index.hpp"

namespace plvo {

// Whether the folder has no rgb.txt or associations.txt, but one of the layouts. The content of the files
// does not matter.
bool is_numbered_folder(const std::filesystem::path& folder);

// Returns kDamaged for an image whose name has no number of at most eight digits, or for two images with one
// number; kInvalidArgument if no number has both images, or if several folders are candidates.
Status read_numbered_index(const std::filesystem::path& folder, double frames_per_s, SequenceIndex& index);

// Reads a 4×4 matrix. usable: all its numbers are finite. Returns kDamaged, naming the file, for a matrix
// that is not a rigid motion; else the status of read_text_file.
Status read_matrix_pose(const std::filesystem::path& path, Se3& pose, bool& usable);

// Reads all poses like read_matrix_pose. At least one pose must be finite (kInvalidArgument).
Status read_numbered_poses(const std::filesystem::path& folder, const std::vector<StampedFile>& files,
                           Trajectory& trajectory);

}  // namespace plvo
