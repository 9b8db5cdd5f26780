// SPDX-License-Identifier: Apache-2.0
// The content of a recorded folder, whatever its layout: pairs of images with stamps, and the files of true
// poses if each frame has one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "plvo/base/status.hpp"
#include "plvo/host/files/trajectory_reader.hpp"

namespace plvo {

struct StampedFile {
  std::int64_t stamp_ns = 0;
  std::string file;  // relative to the folder
};

struct ImagePair {
  StampedFile colour;
  StampedFile depth;
};

struct SequenceIndex {
  std::vector<ImagePair> pairs;  // colour stamps strictly increasing
  std::size_t unpaired_colour = 0;
  std::size_t unpaired_depth = 0;
  bool joint_list = false;         // one list names the pairs, not rgb.txt and depth.txt
  bool numbered = false;           // numbered_index.hpp
  bool in_millimetres = false;     // unit of depth of numbered frames: certain, or only likely
  std::vector<StampedFile> poses;  // of numbered frames
  std::string remark;              // a hint for the user; empty if there is none
};

struct SequenceOptions {
  std::int64_t tolerance_ns = 20'000'000;  // largest difference of the stamps in a pair
  std::filesystem::path associations;      // replaces rgb.txt and depth.txt
  double frames_per_s = 30;                // of numbered frames, which have no stamps
  int scale_down = 0;                      // image_reduction.hpp; 0: the smallest factor that the images need
  std::size_t first_frame = 0;             // of the pairs: [first_frame, end_frame)
  std::size_t end_frame = std::numeric_limits<std::size_t>::max();
};

// Does the same as read_numbered_index for a folder of numbered frames (is_numbered_folder), else as
// read_tum_index. The range of frames is not applied here. Returns kNotFound for a missing folder,
// kUnsupported for a recording of OpenNI2.
Status read_sequence_index(const std::filesystem::path& folder, const SequenceOptions& options,
                           SequenceIndex& index);

// Reads the true poses: groundtruth.txt, or the pose files of numbered frames. Pose files with numbers that
// are not finite are left out and counted in ignored_rows. Returns kNotFound if there are neither.
Status read_ground_truth(const std::filesystem::path& folder, const SequenceOptions& options,
                         Trajectory& trajectory);

bool ends_as_image(std::string_view name);  // .png, .jpg, .jpeg, .ppm or .pgm
bool ends_as_jpeg(std::string_view name);

}  // namespace plvo
