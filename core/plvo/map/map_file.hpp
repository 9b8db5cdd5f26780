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
// The version rises with every change of the format or of the descriptors.
#pragma once

#include <cstdint>

#include "plvo/camera/camera_model.hpp"
#include "plvo/map/map_limits.hpp"
#include "plvo/map/map_stream.hpp"

namespace plvo {

// What the header says.
struct MapFileInfo {
  static constexpr std::uint32_t kVersion = 1;

  // Size and pinhole of the undistorted images, in whose pixels the map's points lie. A camera with another
  // lens may have the same.
  int width = 0, height = 0;
  Pinhole pinhole;
  std::uint32_t keyframes = 0, loops = 0, points = 0, lines = 0;
  std::uint32_t most_points = 0, most_lines = 0;  // of a keyframe

  // Size of the whole file.
  std::size_t bytes() const;
  // The smallest limits that hold this map.
  MapLimits limits() const;
  // A camera with which Map::init accepts this map.
  CameraModel camera() const;
};

// Reads the header. kDamaged: the bytes are not a map, or the header is damaged; kUnsupported: another
// version.
Status read_map_info(ByteSource& source, MapFileInfo& info);

// Size of the largest map that Map::save writes.
std::size_t most_map_file_bytes();

}  // namespace plvo
