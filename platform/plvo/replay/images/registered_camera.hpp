// SPDX-License-Identifier: Apache-2.0
// Registers the depth of any camera, live or recorded, to its colour (depth_registration.hpp): for a source
// that delivers depth as its depth camera sees it.
#pragma once

#include <cstdint>
#include <vector>

#include "plvo/hal/rgbd_camera.hpp"
#include "plvo/replay/images/depth_registration.hpp"

namespace plvo {

class RegisteredCamera final : public RgbdCamera {
 public:
  // source: must outlive this. depth: where its depth camera sits, and its pinhole.
  RegisteredCamera(RgbdCamera& source, const DepthCamera& depth) : source_(source), depth_(depth) {}

  CameraModel model() const override { return source_.model(); }
  // As the source's, with registered depth, which is valid until the next call. It allocates when a first
  // frame comes, and when the size or the unit of depth has changed.
  Status next(RgbdFrame& frame) override;

 private:
  RgbdCamera& source_;
  DepthCamera depth_;
  DepthRegistration registration_;
  int width_ = 0, height_ = 0;  // of depth, in registration_
  double metres_per_unit_ = 0;
  std::vector<std::uint16_t> packed_, registered_;
};

}  // namespace plvo
