// SPDX-License-Identifier: Apache-2.0
// Folders of numbered frames:
//   7-Scenes        frame-000000.color.png  frame-000000.depth.png  frame-000000.pose.txt
//   ScanNet export  color/0.jpg             depth/0.png             pose/0.txt
// and as people name them otherwise:
//   two folders     one whose name begins with color, colour, rgb, image or img, one with depth (or in
//                   capitals); in them names of one number, which is the same
//                   in both
//   one folder      names of one number and a word: color_0.png and depth_0.png, 0-rgb.png and 0-depth.png …
//                   or without a word 0.jpg and 0.png
// A pose file has the 4×4 matrix T_world_camera. There are no stamps: a frame's number divided by the rate of
// frames is its stamp, so that missing numbers are gaps in time.
#pragma once

#include <filesystem>
#include <vector>

#include "plvo/base/status.hpp"
#include "plvo/replay/index/sequence_index.hpp"

namespace plvo {

// No rgb.txt or associations.txt, but one of the layouts. Not decided by what is in the files.
bool is_numbered_folder(const std::filesystem::path& folder);

// kDamaged for an image whose name has no number of at most eight digits, or two images of one number;
// kInvalidArgument when no number has both images, or several folders may be meant.
Status read_numbered_index(const std::filesystem::path& folder, double frames_per_s, SequenceIndex& index);

// A 4×4 matrix. usable: all its numbers are finite. kDamaged, naming the file, for what is no rigid motion;
// else as read_text_file.
Status read_matrix_pose(const std::filesystem::path& path, Se3& pose, bool& usable);

// As read_matrix_pose. At least one pose must be finite (kInvalidArgument).
Status read_numbered_poses(const std::filesystem::path& folder, const std::vector<StampedFile>& files,
                           Trajectory& trajectory);

}  // namespace plvo
