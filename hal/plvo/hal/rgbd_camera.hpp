// SPDX-License-Identifier: Apache-2.0
// A source of RGB-D frames: a live sensor, a recording, a simulator.
#pragma once

#include "plvo/base/status.hpp"
#include "plvo/camera/camera_model.hpp"
#include "plvo/image/frame.hpp"

namespace plvo {

// Whether a camera can be asked again after its next() has come to this.
constexpr bool goes_on_after(StatusCode code) {
  return code == StatusCode::kOk || code == StatusCode::kDamaged || code == StatusCode::kTimeout ||
         code == StatusCode::kUnplugged;
}

class RgbdCamera {
 public:
  // The calibration that the frames of this camera obey, as known after the camera was opened.
  virtual CameraModel model() const = 0;

  // Waits for the next frame. The views in `frame` stay valid until the next call. What else may come back:
  //   kDamaged      this frame is lost (the message says why); the next call goes on after it
  //   kTimeout      nothing came in the camera's time limit; call again
  //   kUnplugged    the device is gone; call again to wait for it to come back
  //   kEndOfStream  nothing more will come
  //   anything else the camera cannot go on
  // Stamps of frames that come back ok are strictly increasing.
  virtual Status next(RgbdFrame& frame) = 0;

 protected:
  // Never deleted through the interface: a virtual destructor would ask every board for operator delete.
  ~RgbdCamera() = default;
};

}  // namespace plvo
