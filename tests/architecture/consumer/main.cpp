// SPDX-License-Identifier: Apache-2.0
// Uses the public API with a memory block whose size is computed at compile time.
#include <cstdio>

#include "plvo/hal/rgbd_camera.hpp"
#include "plvo/odometry/odometry.hpp"

alignas(plvo::kArenaAlignment) static std::byte memory[plvo::required_bytes(plvo::Limits::vga())];

int main() {
  static plvo::Odometry odometry;
  const plvo::Status status = odometry.init(memory, plvo::CameraModel{});
  std::printf("%s, %zu bytes\n", plvo::to_string(status.code()), sizeof memory);
  const plvo::TrackResult result = odometry.track(plvo::RgbdFrame{});  // a frame without images is refused
  return status.ok() && result.status.code() == plvo::StatusCode::kInvalidArgument ? 0 : 1;
}
