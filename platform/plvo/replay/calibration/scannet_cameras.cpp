// SPDX-License-Identifier: Apache-2.0
#include "plvo/replay/calibration/scannet_cameras.hpp"

#include <fmt/core.h>

#include <system_error>

#include "plvo/replay/index/numbered_index.hpp"

namespace plvo {

namespace fs = std::filesystem;

namespace {

constexpr const char* kColourIntrinsic = "intrinsic/intrinsic_color.txt";
constexpr const char* kDepthIntrinsic = "intrinsic/intrinsic_depth.txt";
constexpr const char* kColourExtrinsic = "intrinsic/extrinsic_color.txt";
constexpr const char* kDepthExtrinsic = "intrinsic/extrinsic_depth.txt";

// Returns the identity if there is no file.
Status read_extrinsic(const fs::path& path, Se3& extrinsic) {
  extrinsic = {};
  std::error_code error;
  if (!fs::exists(path, error)) return {};
  bool usable = false;
  Status status = read_matrix_pose(path, extrinsic, usable);
  if (status.ok() && !usable)
    status = {StatusCode::kDamaged, fmt::format("{}: the numbers must be finite", path.string())};
  return status;
}

}  // namespace

std::vector<fs::path> scannet_camera_files(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code error;
  for (const char* name : {kColourIntrinsic, kDepthIntrinsic, kColourExtrinsic, kDepthExtrinsic})
    if (fs::exists(folder / name, error)) files.push_back(folder / name);
  return files;
}

bool has_scannet_cameras(const fs::path& folder) {
  std::error_code error;
  return fs::exists(folder / kColourIntrinsic, error) && fs::exists(folder / kDepthIntrinsic, error);
}

Status read_scannet_cameras(const fs::path& folder, Calibration& calibration) {
  Calibration colour, depth;
  Se3 T_shared_colour, T_shared_depth;
  Status status = read_calibration(folder / kColourIntrinsic, colour);
  if (status.ok()) status = read_calibration(folder / kDepthIntrinsic, depth);
  if (status.ok()) status = read_extrinsic(folder / kColourExtrinsic, T_shared_colour);
  if (status.ok()) status = read_extrinsic(folder / kDepthExtrinsic, T_shared_depth);
  if (!status.ok()) return status;
  const Se3 T_camera_depth = T_shared_colour.inverse() * T_shared_depth;
  const Quaternion q = to_quaternion(T_camera_depth.R);
  const Vector3& t = T_camera_depth.t;
  colour.depth_camera = {true, depth.camera.pinhole, t.x(), t.y(), t.z(), q.x, q.y, q.z, q.w};
  calibration = colour;
  return {};
}

}  // namespace plvo
