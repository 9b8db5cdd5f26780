// SPDX-License-Identifier: Apache-2.0
// What a recorded folder offers, whichever layout it has: pairs of images with stamps, and where each frame
// has a file for its true pose, those.
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
  bool in_millimetres = false;     // depth of numbered frames, for sure; else most probably
  std::vector<StampedFile> poses;  // of numbered frames
  std::string remark;              // what whoever runs the sequence should know; empty where there is nothing
};

struct SequenceOptions {
  std::int64_t tolerance_ns = 20'000'000;  // largest difference of the stamps in a pair
  std::filesystem::path associations;      // instead of rgb.txt and depth.txt
  double frames_per_s = 30;                // of numbered frames, which have no stamps
  int scale_down = 0;                      // image_reduction.hpp; 0: by as little as the images need
  std::size_t first_frame = 0;             // of the pairs: [first_frame, end_frame)
  std::size_t end_frame = std::numeric_limits<std::size_t>::max();
};

// As read_numbered_index for a folder of numbered frames (is_numbered_folder), else as read_tum_index. Frames
// are not chosen here. kNotFound for a missing folder, kUnsupported for a recording of OpenNI2.
Status read_sequence_index(const std::filesystem::path& folder, const SequenceOptions& options,
                           SequenceIndex& index);

// The true poses: groundtruth.txt, or the pose files of numbered frames, of which those with numbers that are
// not finite are left out and counted in ignored_rows. kNotFound when there are neither.
Status read_ground_truth(const std::filesystem::path& folder, const SequenceOptions& options,
                         Trajectory& trajectory);

bool ends_as_image(std::string_view name);  // .png, .jpg, .jpeg, .ppm or .pgm
bool ends_as_jpeg(std::string_view name);

}  // namespace plvo
