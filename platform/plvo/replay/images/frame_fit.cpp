// SPDX-License-Identifier: Apache-2.0
#include "plvo/replay/images/frame_fit.hpp"

#include <fmt/core.h>

#include <algorithm>

namespace plvo {
namespace {

std::size_t pixels_of(int width, int height) {
  return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
}

}  // namespace

Status FrameFit::init(const Calibration& calibration, const ImageSize& colour, const ImageSize& depth,
                      int scale_down) {
  whole_ = {};
  calibration_ = calibration;
  if (Status status = choose_registration(colour, depth); !status.ok()) return status;
  if (Status status = calibration.validate(colour.width, colour.height, depth.width, depth.height);
      !status.ok())
    return status;
  if (calibration.depth_camera.as_colour) {
    calibration_.depth_camera.as_colour = false;
    calibration_.depth_camera.pinhole = calibration.camera.pinhole;
  }
  calibration_.camera.width = colour.width;
  calibration_.camera.height = colour.height;
  if (Status status = choose_scale(colour, scale_down); !status.ok()) return status;
  calibration_.has_size = true;

  const std::size_t pixels = pixels_of(calibration_.camera.width, calibration_.camera.height);
  colour_.assign(3 * pixels, 0);
  depth_.assign(pixels, 0);
  if (whole_.factor > 1) whole_colour_.assign(3 * pixels_of(whole_.width, whole_.height), 0);
  if (registers_) {
    raw_depth_.assign(pixels_of(depth.width, depth.height), 0);
    registration_.init(calibration_.camera, whole_, calibration_.depth_camera, depth.width, depth.height,
                       1 / calibration_.depth_units_per_metre);
  }
  return {};
}

Status FrameFit::choose_registration(const ImageSize& colour, const ImageSize& depth) {
  const bool same_size = colour.width == depth.width && colour.height == depth.height;
  const DepthCamera& camera = calibration_.depth_camera;
  registers_ = camera.known || !same_size;
  if (same_size || (camera.known && !camera.as_colour)) return {};
  if (camera.known)
    return {StatusCode::kInvalidArgument,
            fmt::format("colour is {}x{} but depth is {}x{}; where they differ, say depth's own camera: "
                        "depth_fx depth_fy depth_cx depth_cy (share/doc/plvo/user/recordings.md)",
                        colour.width, colour.height, depth.width, depth.height)};
  // Only with a size is the calibration known to be that of colour: one for a smaller depth image would pass
  // unnoticed.
  if (calibration_.has_size &&
      DepthRegistration::same_view(colour.width, colour.height, depth.width, depth.height))
    return {};
  return {StatusCode::kInvalidArgument,
          fmt::format("colour is {}x{} but depth is {}x{}; export colour at the size of depth, or say in the "
                      "calibration its width and height, if both have one view, or depth's camera: "
                      "depth_fx depth_fy depth_cx depth_cy (share/doc/plvo/user/recordings.md)",
                      colour.width, colour.height, depth.width, depth.height)};
}

Status FrameFit::choose_scale(const ImageSize& colour, int scale_down) {
  const int factor = scale_down != 0 ? scale_down : least_reduction(colour.width, colour.height);
  whole_ = {factor, colour.width, colour.height};
  if (Status status = check_reduction(factor, colour.width, colour.height); !status.ok()) return status;
  calibration_.camera = reduced(calibration_.camera, factor);
  registers_ |= factor > 1;
  remark_.clear();
  if (scale_down == 0 && factor > 1)
    remark_ = fmt::format(
        "the images of {}x{} are larger than plvo takes: they are scaled down by {}, to {}x{}, and the "
        "calibration with them",
        colour.width, colour.height, factor, calibration_.camera.width, calibration_.camera.height);
  return {};
}

void FrameFit::fit(RgbdFrame& frame) {
  std::replace(depth().begin(), depth().end(), kDepthBeyondRange, std::uint16_t{0});
  const int width = calibration_.camera.width, height = calibration_.camera.height;
  if (whole_.factor > 1)
    reduce_rgb(whole_colour_.data(), whole_.width, whole_.factor, width, height, colour_.data());
  if (registers_) registration_.warp(raw_depth_.data(), depth_.data());
  frame.colour = {colour_.data(), width, height, width * std::ptrdiff_t{3}, PixelFormat::kRgb8};
  frame.depth = {depth_.data(), width, height, width, 1.0 / calibration_.depth_units_per_metre};
}

}  // namespace plvo
