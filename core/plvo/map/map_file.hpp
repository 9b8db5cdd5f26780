// SPDX-License-Identifier: Apache-2.0
// The format of a saved map (Map::save and Map::load). All numbers are little-endian; a pose is R row by row,
// then t; a matrix is row by row.
//
//   header     "plvo map" · version · width height (u32) · fx fy cx cy (f64) · keyframes, loops, points,
//              lines, most points and most lines of a keyframe (u32) · CRC-32 of the header
//   keyframe   in the order of the chain: id, part (u32) · slot, points, lines (u16) · T_map_keyframe ·
//              T_previous_keyframe · both covariances, 6×6 · its points · its lines
//   point      descriptor (4 u64) · u v depth (f32) · σ_d in 0.1 mm (u16) · level, tables of the index (u8)
//   line       descriptor (72 u8) · both ends (6 f32) · covariance across the line (10 f32)
//   loop       slots (2 u16) · T_older_newer · covariance
//   end        CRC-32 of all after the header
//
// The version rises with every change, and when descriptors come to mean something else.
#pragma once

#include <cstdint>

#include "plvo/camera/camera_model.hpp"
#include "plvo/map/map_limits.hpp"
#include "plvo/map/map_stream.hpp"

namespace plvo {

// What the header says.
struct MapFileInfo {
  static constexpr std::uint32_t kVersion = 1;

  // Of the undistorted images: the map's points are pixels of this pinhole. The lens may be another one.
  int width = 0, height = 0;
  Pinhole pinhole;
  std::uint32_t keyframes = 0, loops = 0, points = 0, lines = 0;
  std::uint32_t most_points = 0, most_lines = 0;  // of a keyframe

  // Of the whole file.
  std::size_t bytes() const;
  // The smallest limits that hold this map.
  MapLimits limits() const;
  // A camera that Map::init takes for this map.
  CameraModel camera() const;
};

// Reads the header. kDamaged: these bytes are no map, or a damaged one; kUnsupported: another version.
Status read_map_info(ByteSource& source, MapFileInfo& info);

// Of the largest map that Map::save writes.
std::size_t most_map_file_bytes();

}  // namespace plvo
