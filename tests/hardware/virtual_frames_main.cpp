// SPDX-License-Identifier: Apache-2.0
// plvo_virtual_frames RAW FOLDER FRAMES [SCENE]: writes 320x240 simulated frames for PLVO_VIRTUAL_FRAMES, and
// the same frames as a TUM folder.
#include <cstdio>
#include <cstdlib>

#include "virtual_frames.hpp"

int main(int argc, char** argv) {
  plvo::SimulatorOptions options;
  if (argc < 4 || (options.frames = std::atoi(argv[3])) <= 0 ||
      (argc > 4 && !plvo::parse_scene(argv[4], options.scene).ok())) {
    std::fprintf(stderr, "usage: %s RAW FOLDER FRAMES [SCENE]\n", argv[0]);
    return 2;
  }
  options.camera.width = 320;
  options.camera.height = 240;
  options.camera.pinhole = {262.5, 262.5, 159.5, 119.5};
  const plvo::Status status = plvo_test::write_virtual_frames(options, argv[1], argv[2]);
  if (!status.ok()) std::fprintf(stderr, "%s\n", status.message());
  return status.ok() ? 0 : 1;
}
