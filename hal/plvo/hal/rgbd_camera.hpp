// SPDX-License-Identifier: Apache-2.0
// A source of RGB-D frames: a live sensor, a recording, a simulator.
#pragma once

#include "plvo/base/status.hpp"
#include "plvo/camera/camera_model.hpp"
#include "plvo/image/frame.hpp"

namespace plvo {

// Returns whether next() may be called again after it has returned this code.
constexpr bool goes_on_after(StatusCode code) {
  return code == StatusCode::kOk || code == StatusCode::kDamaged || code == StatusCode::kTimeout ||
         code == StatusCode::kUnplugged;
}

class RgbdCamera {
 public:
  // The calibration of this camera's frames, as known once the camera is open.
  virtual CameraModel model() const = 0;

  // Waits for the next frame. The views in `frame` stay valid until the next call. Other results:
  //   kDamaged      this frame is lost (the message says why); the next call continues after it
  //   kTimeout      no frame came within the camera's time limit; call again
  //   kUnplugged    the device was disconnected; call again to wait for it to come back
  //   kEndOfStream  no further frames will come
  //   anything else the camera cannot continue
  // Stamps of frames that are returned with kOk are strictly increasing.
  virtual Status next(RgbdFrame& frame) = 0;

 protected:
  // Never deleted through the interface: a virtual destructor would require operator delete on every board.
  ~RgbdCamera() = default;
};

}  // namespace plvo
