// SPDX-License-Identifier: Apache-2.0
// One sequence of the procedural room as three folders with the same images and the same stamps: TUM's
// layout, that of 7-Scenes and that of ScanNet's exports. In the latter two, some pixels without depth are
// 65535, as in 7-Scenes.
#pragma once

#include <fmt/core.h>

#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "plvo/replay/images/image_writer.hpp"
#include "plvo/replay/tum_writer.hpp"
#include "procedural_sequence.hpp"
#include "temporary_folder.hpp"

namespace plvo::test {

inline constexpr int kNumberedFrames = 6;

inline std::string seven_scenes_file(const char* kind, int number) {
  return fmt::format("frame-{:06}.{}.{}", number, kind, std::string_view(kind) == "pose" ? "txt" : "png");
}

inline std::string scannet_file(const char* kind, int number) {
  return fmt::format("{}/{}.{}", kind, number, std::string_view(kind) == "pose" ? "txt" : "png");
}

inline std::string matrix_text(const Se3& T) {
  std::string text;
  for (int row = 0; row < 3; ++row)
    text += fmt::format("{} {} {} {}\n", T.R(row, 0), T.R(row, 1), T.R(row, 2), T.t[row]);
  return text + "0 0 0 1\n";
}

class NumberedSequence {
 public:
  NumberedSequence() {
    ProceduralSequence room(320, 240);
    for (const char* kind : {"color", "depth", "pose", "intrinsic"})
      std::filesystem::create_directories(scannet() / kind);
    std::filesystem::create_directories(seven_scenes());
    Calibration calibration;
    calibration.camera.pinhole = room.camera().pinhole;
    calibration.depth_units_per_metre = 1000;
    calibration.depth_scale_given = calibration.readout_given = true;
    TumWriter writer;
    good_ = writer.open(tum(), calibration).ok();
    for (int i = 0; i < kNumberedFrames; ++i) write(room.render(i), i, writer);
    write_file(seven_scenes() / "calibration.txt", calibration_text(calibration));
    const Pinhole& k = calibration.camera.pinhole;
    write_file(scannet() / "intrinsic/intrinsic_depth.txt",
               fmt::format("{} 0 {} 0\n0 {} {} 0\n0 0 1 0\n0 0 0 1\n", k.fx, k.cx, k.fy, k.cy));
  }

  bool good() const { return good_; }
  std::filesystem::path tum() const { return folder_ / "tum"; }
  std::filesystem::path seven_scenes() const { return folder_ / "seven"; }
  std::filesystem::path scannet() const { return folder_ / "scannet"; }

 private:
  void write(RgbdFrame frame, int number, TumWriter& writer) {
    frame.stamp_ns = frame.depth_stamp_ns = std::llround(number * 1e9 / 30);
    const Se3 pose = ProceduralRenderer::T_world_camera(number);
    good_ = good_ && writer.write(frame, &pose).ok();
    std::vector<std::uint16_t> depth(frame.depth.data, frame.depth.data + 320 * 240);
    std::size_t holes = 0;
    for (std::uint16_t& value : depth)
      if (value == 0 && holes++ % 2 == 0) value = 65535;
    good_ = good_ && holes > 0;
    frame.depth.data = depth.data();
    for (const auto& [folder, name] :
         {std::pair(seven_scenes(), &seven_scenes_file), std::pair(scannet(), &scannet_file)}) {
      good_ = good_ && write_png(folder / name("color", number), frame.colour).ok() &&
              write_png(folder / name("depth", number), frame.depth).ok();
      write_file(folder / name("pose", number), matrix_text(pose));
    }
  }

  TemporaryFolder folder_;
  bool good_ = false;
};

}  // namespace plvo::test
