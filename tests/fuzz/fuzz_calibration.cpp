// SPDX-License-Identifier: Apache-2.0
// Any bytes as a calibration, in each of our formats and those of other programs. The reader refuses them
// with a message, or returns a usable calibration.
#include <string>
#include <string_view>

#include "plvo/replay/calibration/calibration.hpp"
#include "scratch_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace plvo;
  for (const char* name : {"calibration.txt", "camera_info.yaml"}) {
    Calibration calibration;
    const Status status = read_calibration(fuzz::write_scratch(name, data, size), calibration);
    fuzz::require(status.ok() || !std::string_view(status.message()).empty());
    if (!status.ok() || !calibration.validate(640, 480).ok()) continue;
    fuzz::require(!calibration.depth_camera.known || calibration.depth_camera.as_colour ||
                  back_project(calibration.depth_camera.pinhole, 0, 0, 1).allFinite());
    // A calibration that was read survives writing and reading, to the last bit.
    const std::string text = calibration_text(calibration);
    Calibration again;
    const auto written =
        fuzz::write_scratch("again.txt", reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
    fuzz::require(read_calibration(written, again).ok() && calibration_text(again) == text);
    CameraModel camera = calibration.camera;
    camera.width = 640;
    camera.height = 480;
    for (int v = 0; v < 480; v += 60)
      for (int u = 0; u < 640; u += 60) fuzz::require(undistort_pixel(camera, Vector2(u, v)).allFinite());
  }
  return 0;
}
