// SPDX-License-Identifier: Apache-2.0
#include "plvo/replay/calibration.hpp"

#include <gtest/gtest.h>

#include <string>

#include "temporary_folder.hpp"

namespace plvo {
namespace {

using test::TemporaryFolder;
using test::write_file;

Status read_text(const std::string& text, Calibration& calibration, const char* name = "calibration.txt") {
  const TemporaryFolder folder;
  write_file(folder / name, text);
  return read_calibration(folder / name, calibration);
}

bool says(const Status& status, std::string_view words) {
  return std::string_view(status.message()).find(words) != std::string_view::npos;
}

TEST(Calibration, ReadsNumbers) {
  Calibration c;
  ASSERT_TRUE(read_text("# a comment\n525 526 319.5 239.5 1000\n", c).ok());
  EXPECT_EQ(c.camera.pinhole.fy, 526);
  EXPECT_EQ(c.depth_units_per_metre, 1000);
  EXPECT_TRUE(c.camera.distortion.is_zero());
  ASSERT_TRUE(read_text("517.3 516.4 318.6 255.3 5000 0.26 -0.95 -0.005 0.0026 1.16", c).ok());
  EXPECT_EQ(c.camera.distortion.k3, 1.16);
  EXPECT_EQ(c.camera.distortion.p1, -0.005);
  EXPECT_TRUE(c.validate(640, 480).ok());
}

TEST(Calibration, ReadsKeys) {
  Calibration c;
  ASSERT_TRUE(
      read_text("fx: 525\nfy = 526\ncx 319.5\ncy 239.5\ndepth_scale 1000\nk1 0.1\nwidth 640\nheight 480\n", c)
          .ok());
  EXPECT_EQ(c.camera.pinhole.cx, 319.5);
  EXPECT_EQ(c.camera.distortion.k1, 0.1);
  EXPECT_TRUE(c.has_size);
  EXPECT_TRUE(c.validate(640, 480).ok());
  EXPECT_TRUE(says(c.validate(320, 240), "is for 640x480 images, these are 320x240"));
}

TEST(Calibration, RefusesWhatItDoesNotUnderstand) {
  Calibration c;
  EXPECT_EQ(read_text("", c).code(), StatusCode::kDamaged);
  EXPECT_TRUE(says(read_text("525 525 319.5", c), "3 numbers; expected 'fx fy cx cy depth_scale'"));
  EXPECT_TRUE(says(read_text("525 525 319.5 abc 5000", c), "'abc' is not a number"));
  EXPECT_TRUE(says(read_text("fx 525\nfz 3\n", c), "'fz' is not known"));
  EXPECT_TRUE(says(read_text("fx 525\nfy\n", c), "'fy' needs a number"));
  EXPECT_TRUE(says(read_text("fx 525\n", c), "must all be given"));
  EXPECT_EQ(read_calibration("/nowhere/calibration.txt", c).code(), StatusCode::kNotFound);
}

TEST(Calibration, RefusesNaN) {
  Calibration c;
  ASSERT_TRUE(read_text("nan 525 319.5 239.5 5000", c).ok());  // a number to the reader, not to the camera
  EXPECT_TRUE(says(c.validate(640, 480), "fx and fy must be positive numbers"));
  ASSERT_TRUE(read_text("525 525 319.5 239.5 nan", c).ok());
  EXPECT_TRUE(says(c.validate(640, 480), "depth_scale must be a positive number"));
}

constexpr const char* kCameraInfo =
    "image_width: 640\nimage_height: 480\ncamera_name: rgb\ncamera_matrix:\n  rows: 3\n  cols: 3\n"
    "  data: [517.3, 0, 318.6, 0, 516.5, 255.3, 0, 0, 1]\ndistortion_model: plumb_bob\n"
    "distortion_coefficients:\n  rows: 1\n  cols: 5\n  data: [0.26, -0.95, -0.005, 0.002, 1.16]\n";

TEST(Calibration, ReadsRosCameraInfo) {
  Calibration c;
  const Status status = read_text(kCameraInfo, c, "rgb.yaml");
  ASSERT_TRUE(status.ok()) << status.message();
  EXPECT_EQ(c.camera.pinhole.fx, 517.3);
  EXPECT_EQ(c.camera.pinhole.fy, 516.5);
  EXPECT_EQ(c.camera.pinhole.cx, 318.6);
  EXPECT_EQ(c.camera.pinhole.cy, 255.3);
  EXPECT_EQ(c.camera.distortion.p2, 0.002);
  EXPECT_EQ(c.camera.distortion.k3, 1.16);
  EXPECT_TRUE(c.has_size);

  Calibration echoed;  // as `rostopic echo` prints the message
  ASSERT_TRUE(read_text("height: 480\nwidth: 640\ndistortion_model: plumb_bob\nD: [0.1, 0, 0, 0, 0]\n"
                        "K: [500, 0, 320, 0, 501, 240, 0, 0, 1]\n",
                        echoed, "info.yaml")
                  .ok());
  EXPECT_EQ(echoed.camera.pinhole.fy, 501);
  EXPECT_EQ(echoed.camera.distortion.k1, 0.1);
}

TEST(Calibration, RefusesOtherDistortionModels) {
  Calibration c;
  std::string text = kCameraInfo;
  text.replace(text.find("plumb_bob"), 9, "equidistant");
  const Status status = read_text(text, c, "rgb.yaml");
  EXPECT_EQ(status.code(), StatusCode::kUnsupported);
  EXPECT_TRUE(says(status, "'equidistant' is not supported, only plumb_bob")) << status.message();
}

TEST(Calibration, RefusesBrokenYaml) {
  Calibration c;
  EXPECT_EQ(read_text("camera_matrix: [1, 2", c, "rgb.yaml").code(), StatusCode::kDamaged);
  EXPECT_EQ(read_text("just words\n", c, "rgb.yaml").code(), StatusCode::kDamaged);
  EXPECT_EQ(read_text("camera_matrix: {data: [1, 2, x, 0, 0, 0, 0, 0, 0]}\n", c, "rgb.yaml").code(),
            StatusCode::kDamaged);
}

TEST(Calibration, BuiltinNames) {
  for (std::string_view name : builtin_calibration_names()) {
    Calibration c;
    EXPECT_TRUE(builtin_calibration(name, c).ok());
    EXPECT_TRUE(c.validate(640, 480).ok()) << name;
  }
  Calibration fr1;
  ASSERT_TRUE(builtin_calibration("tum-fr1", fr1).ok());
  EXPECT_EQ(fr1.camera.pinhole.cy, 255.313989);
  EXPECT_EQ(fr1.camera.distortion.k2, -0.953104);
  EXPECT_TRUE(says(builtin_calibration("tum-fr9", fr1), "the names are tum-fr1 tum-fr2"));
}

}  // namespace
}  // namespace plvo
