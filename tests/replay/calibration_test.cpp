// SPDX-License-Identifier: Apache-2.0
#include "plvo/replay/calibration/calibration.hpp"

#include <gtest/gtest.h>

#include <string>

#include "says.hpp"
#include "temporary_folder.hpp"

namespace plvo {
namespace {

using test::says;
using test::TemporaryFolder;
using test::write_file;

Status read_text(const std::string& text, Calibration& calibration, const char* name = "calibration.txt") {
  const TemporaryFolder folder;
  write_file(folder / name, text);
  return read_calibration(folder / name, calibration);
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

TEST(Calibration, NumbersMayEndEarly) {
  Calibration c;
  ASSERT_TRUE(read_text("525 526 319.5 239.5\n", c).ok());
  EXPECT_EQ(c.camera.pinhole.cy, 239.5);
  EXPECT_EQ(c.depth_units_per_metre, 5000);
  EXPECT_FALSE(c.depth_scale_given);
  EXPECT_FALSE(c.readout_given);
  ASSERT_TRUE(read_text("525 526 319.5 239.5 1000\n", c).ok());
  EXPECT_TRUE(c.depth_scale_given);
  EXPECT_FALSE(c.readout_given);
  ASSERT_TRUE(read_text("525 526 319.5 239.5 1000 0 0 0 0 0 0\n", c).ok());
  EXPECT_TRUE(c.readout_given) << "a global shutter that was said";
  EXPECT_TRUE(says(read_text("525 526 319.5 239.5 5000 0.1 0.2 0.3 0.4\n", c), "has 9 numbers; expected"));
}

TEST(Calibration, KeysMayFollowNumbers) {
  Calibration c;
  ASSERT_TRUE(read_text("525 526 319.5 239.5 # no scale\nreadout_s: 0.0261\ndepth_scale 1000\n", c).ok());
  EXPECT_EQ(c.camera.readout_s, 0.0261);
  EXPECT_EQ(c.depth_units_per_metre, 1000);
  EXPECT_TRUE(c.assumptions().empty());
  EXPECT_TRUE(
      says(read_text("525 526 319.5 239.5 1000\ndepth_scale 5000\n", c), "'depth_scale' is said twice"));
  EXPECT_TRUE(says(read_text("fx 525\nfx 526\n", c), "'fx' is said twice"));
}

TEST(Calibration, IgnoresAByteOrderMark) {
  Calibration c;
  ASSERT_TRUE(read_text("\xEF\xBB\xBF"
                        "525 526 319.5 239.5 1000",
                        c)
                  .ok());
  EXPECT_EQ(c.camera.pinhole.fx, 525);
  ASSERT_TRUE(read_text("\xEF\xBB\xBF"
                        "fx: 525\nfy: 525\ncx: 1\ncy: 1\n",
                        c, "c.yaml")
                  .ok());
  EXPECT_TRUE(says(read_text(std::string("\xFF\xFE"
                                         "5\0",
                                         4),
                             c),
                   "UTF-16"));
}

// Each assumed value is reported, with a remedy.
TEST(Calibration, ReportsItsAssumptions) {
  Calibration c;
  ASSERT_TRUE(read_text("525 526 319.5 239.5\n", c).ok());
  const std::vector<std::string> assumed = c.assumptions();
  ASSERT_EQ(assumed.size(), 2u);
  EXPECT_NE(assumed[0].find("5000 units per metre are assumed"), std::string::npos) << assumed[0];
  EXPECT_NE(assumed[1].find("a global shutter is assumed"), std::string::npos) << assumed[1];
  EXPECT_NE(assumed[1].find("--readout 0.0261"), std::string::npos) << assumed[1];
  for (std::string_view name : builtin_calibration_names()) {
    ASSERT_TRUE(builtin_calibration(name, c).ok());
    EXPECT_TRUE(c.readout_given) << name;
    EXPECT_EQ(c.depth_scale_given, name.starts_with("tum-") || name == "7scenes") << name;
    EXPECT_EQ(c.guess.empty(), name != "7scenes") << name;
  }
}

TEST(Calibration, RoundTripsToTheLastBit) {
  Calibration written;
  written.camera.pinhole = {517.3064081, 1 / 3.0 + 500, 318.6, 255.1};
  written.camera.distortion = {0.1 + 0.2, -1e-17, 1e-300, 2.0 / 3, -0.0};
  written.camera.readout_s = 0.0261;
  written.depth_units_per_metre = 1000.0000000000001;
  written.readout_given = true;
  Calibration read;
  ASSERT_TRUE(read_text(calibration_text(written), read).ok());
  EXPECT_EQ(read.camera.pinhole.fy, written.camera.pinhole.fy);
  EXPECT_EQ(read.camera.distortion.k1, written.camera.distortion.k1);
  EXPECT_EQ(read.camera.distortion.p1, written.camera.distortion.p1);
  EXPECT_EQ(read.camera.readout_s, written.camera.readout_s);
  EXPECT_EQ(read.depth_units_per_metre, written.depth_units_per_metre);
  EXPECT_EQ(calibration_text(read), calibration_text(written));
}

TEST(Calibration, RoundTripsDepthTiming) {
  Calibration c;
  ASSERT_TRUE(read_text("525 525 319.5 239.5 5000 0 0 0 0 0 0.03\ndepth_delay_s -0.015\n", c).ok());
  EXPECT_TRUE(c.camera.depth_timing.known);
  EXPECT_EQ(c.camera.depth_timing.delay_s, -0.015);
  EXPECT_EQ(c.camera.depth_timing.readout_s, 0.03) << "as colour, unless it is said";
  ASSERT_TRUE(read_text("525 525 319.5 239.5 5000\ndepth_delay_s 0\ndepth_readout_s 0.02\n", c).ok());
  EXPECT_TRUE(c.camera.depth_timing.known) << "a delay of nothing is known, too";
  EXPECT_EQ(c.camera.depth_timing.readout_s, 0.02);
  Calibration again;
  ASSERT_TRUE(read_text(calibration_text(c), again).ok()) << calibration_text(c);
  EXPECT_TRUE(again.camera.depth_timing.known);
  EXPECT_EQ(again.camera.depth_timing.readout_s, 0.02);
  ASSERT_TRUE(read_text("525 525 319.5 239.5", c).ok());
  EXPECT_FALSE(c.camera.depth_timing.known);
  EXPECT_TRUE(says(read_text("525 525 319.5 239.5\ndepth_readout_s 0.02", c), "needs depth_delay_s"));
  ASSERT_TRUE(builtin_calibration("tum-fr1", c).ok());
  EXPECT_TRUE(c.camera.depth_timing.known);
}

TEST(Calibration, RoundTripsStampSigma) {
  Calibration c;
  ASSERT_TRUE(read_text("525 525 319.5 239.5 5000\nstamp_sigma_s 0.002\n", c).ok());
  EXPECT_EQ(c.camera.stamp_sigma_s, 0.002);
  EXPECT_FALSE(c.camera.depth_timing.known);
  Calibration again;
  ASSERT_TRUE(read_text(calibration_text(c), again).ok()) << calibration_text(c);
  EXPECT_EQ(again.camera.stamp_sigma_s, 0.002);
  again = {};
  ASSERT_TRUE(read_text(calibration_lines(c), again).ok()) << calibration_lines(c);
  EXPECT_EQ(again.camera.stamp_sigma_s, 0.002);
  c.camera.stamp_sigma_s = 0;
  EXPECT_EQ(calibration_text(c).find("stamp_sigma_s"), std::string::npos);
  EXPECT_EQ(calibration_lines(c).find("stamp_sigma_s"), std::string::npos);
  c.camera.stamp_sigma_s = 0.2;
  EXPECT_TRUE(says(c.validate(640, 480), "deviation of the stamps"));
}

TEST(Calibration, RejectsInvalidText) {
  Calibration c;
  EXPECT_EQ(read_text("", c).code(), StatusCode::kDamaged);
  EXPECT_TRUE(says(read_text("525 525 319.5", c), "3 numbers; expected 'fx fy cx cy [depth_scale"));
  EXPECT_TRUE(says(read_text("525 525 319.5 abc 5000", c), "'abc' is not a number"));
  EXPECT_TRUE(says(read_text("fx 525\nfz 3\n", c), "'fz' is not known"));
  EXPECT_TRUE(says(read_text("fx 525\nfy\n", c), "'fy' needs a number"));
  EXPECT_TRUE(says(read_text("fx 525\n", c), "must all be given"));
  EXPECT_EQ(read_calibration("/nowhere/calibration.txt", c).code(), StatusCode::kNotFound);
}

// In the form of ScanNet's exports.
TEST(Calibration, ReadsAMatrix) {
  const std::string matrix = "577.87 0 319.5 0\n0 578.5 239.5 0\n0 0 1 0\n0 0 0 1\n";
  Calibration c;
  ASSERT_TRUE(read_text(matrix, c).ok());
  EXPECT_EQ(c.camera.pinhole.fx, 577.87);
  EXPECT_EQ(c.camera.pinhole.fy, 578.5);
  EXPECT_EQ(c.camera.pinhole.cx, 319.5);
  EXPECT_EQ(c.camera.pinhole.cy, 239.5);
  EXPECT_TRUE(c.camera.distortion.is_zero());
  EXPECT_FALSE(c.depth_scale_given);
  ASSERT_TRUE(read_text(matrix + "depth_scale 1000\n", c).ok());
  EXPECT_EQ(c.depth_units_per_metre, 1000);
  // With three rows, as OpenCV and numpy write it and as they print it.
  for (const char* text :
       {"577.87 0 319.5\n0 578.5 239.5\n0 0 1\n",
        "[[577.87, 0., 319.5],\n [0., 578.5, 239.5],\n [0., 0., 1.]]\n",
        "5.7787e+02 0.0e+00 3.195e+02\n0.0e+00 5.785e+02 2.395e+02\n0.0e+00 0.0e+00 1.0e+00\n"}) {
    c = {};
    const Status status = read_text(text, c);
    ASSERT_TRUE(status.ok()) << status.message();
    const Pinhole& k = c.camera.pinhole;
    EXPECT_TRUE(k.fx == 577.87 && k.fy == 578.5 && k.cx == 319.5 && k.cy == 239.5) << text;
  }
  EXPECT_TRUE(says(read_text("577 2 319.5\n0 578.5 239.5\n0 0 1\n", c), "has 9 numbers; expected"));
  // A pose is not a camera matrix.
  EXPECT_TRUE(says(read_text("0.8 0 0.6 1.5\n0 1 0 -0.2\n-0.6 0 0.8 2\n0 0 0 1\n", c),
                   "has 16 numbers; expected 'fx fy cx cy [depth_scale"));
}

TEST(Calibration, RejectsNaN) {
  Calibration c;
  ASSERT_TRUE(read_text("nan 525 319.5 239.5 5000", c)
                  .ok());  // the reader accepts nan as a number, the camera does not
  EXPECT_TRUE(says(c.validate(640, 480), "fx and fy must be numbers from 1 to 100000"));
  ASSERT_TRUE(read_text("525 525 319.5 239.5 nan", c).ok());
  EXPECT_TRUE(says(c.validate(640, 480), "depth_scale must lie between 1 and 100000"));
  for (const char* scale : {"0", "-5000", "0.001", "1e300", "inf"}) {
    ASSERT_TRUE(read_text(std::string("525 525 319.5 239.5 ") + scale, c).ok());
    EXPECT_TRUE(says(c.validate(640, 480), "not metres per unit")) << scale;
  }
}

TEST(Calibration, RejectsNumbersOutOfRange) {
  Calibration c;
  for (const char* pinhole : {"1e308 525 319.5 239.5", "525 1e-300 319.5 239.5", "525 100001 319.5 239.5"}) {
    ASSERT_TRUE(read_text(pinhole, c).ok());
    EXPECT_TRUE(says(c.validate(640, 480), "fx and fy must be numbers from 1 to 100000")) << pinhole;
    std::string depth = std::string("525 525 319.5 239.5\n");
    std::size_t i = 0;
    for (const char* key : {"depth_fx", "depth_fy", "depth_cx", "depth_cy"}) {
      const std::string rest(pinhole + i);
      depth += std::string(key) + ' ' + rest.substr(0, rest.find(' ')) + '\n';
      i += rest.find(' ') + 1;
    }
    ASSERT_TRUE(read_text(depth, c).ok()) << depth;
    const Status status = c.validate(640, 480);
    EXPECT_TRUE(
        says(status, "depth_fx depth_fy depth_cx depth_cy, of the camera of depth images of 640x480: "))
        << status.message();
    EXPECT_TRUE(says(status, "fx and fy must be numbers from 1 to 100000")) << status.message();
  }
  ASSERT_TRUE(
      read_text("525 525 319.5 239.5\ndepth_fx 260\ndepth_fy 260\ndepth_cx 330\ndepth_cy 120\n", c).ok());
  EXPECT_TRUE(c.validate(640, 480).ok());
  EXPECT_TRUE(says(c.validate(640, 480, 320, 240), "cx and cy must lie inside the image"));
}

// The size is checked before parsing: a YAML of 1 MB took seconds to reject.
TEST(Calibration, RejectsTooLargeFiles) {
  Calibration c;
  for (const char* name : {"calibration.txt", "calibration.yaml"}) {
    std::string text = "fx: 525\nfy: 526\ncx: 319.5\ncy: 239.5\n";
    text += '#' + std::string(kMaxCalibrationBytes - text.size() - 1, ' ');
    EXPECT_TRUE(read_text(text, c, name).ok()) << name;
    EXPECT_TRUE(says(read_text(text + ' ', c, name), "it has 65537 bytes, more than the 65536")) << name;
  }
}

TEST(Calibration, RejectsInvalidSizes) {
  Calibration c;
  const std::string lens = "fx 525\nfy 525\ncx 319.5\ncy 239.5\n";
  for (const char* width : {"nan", "1e300", "-640", "0", "640.5", "inf"})
    EXPECT_TRUE(says(read_text(lens + "height 480\nwidth " + width, c), "whole numbers of pixels")) << width;
  EXPECT_TRUE(says(read_text(lens + "width 640\n", c), "both, or neither"));
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

// A camera_info has neither the depth unit nor the readout time; keys for both may stand beside it.
TEST(Calibration, ReadsSensorKeysBesideCameraInfo) {
  Calibration c;
  ASSERT_TRUE(read_text(kCameraInfo, c, "rgb.yaml").ok());
  EXPECT_FALSE(c.depth_scale_given);
  EXPECT_FALSE(c.readout_given);
  EXPECT_EQ(c.assumptions().size(), 2u);
  ASSERT_TRUE(
      read_text(std::string(kCameraInfo) + "depth_scale: 1000\nreadout_s: 0.02\n", c, "rgb.yml").ok());
  EXPECT_EQ(c.depth_units_per_metre, 1000);
  EXPECT_EQ(c.camera.readout_s, 0.02);
  EXPECT_TRUE(c.assumptions().empty());
  EXPECT_TRUE(says(read_text(std::string(kCameraInfo) + "depth_scale: [1]\n", c, "a.yaml"),
                   "'depth_scale' needs a number"));
}

TEST(Calibration, ReadsKeysInYaml) {
  Calibration c;
  const Status status = read_text(
      "# ours\nfx: 525\nfy: 526\ncx: 319.5\ncy: 239.5\ndepth_scale: 1000\n"
      "readout_s: 0.0261\nwidth: 640\nheight: 480\n",
      c, "calibration.yaml");
  ASSERT_TRUE(status.ok()) << status.message();
  EXPECT_EQ(c.camera.pinhole.fy, 526);
  EXPECT_EQ(c.camera.readout_s, 0.0261);
  EXPECT_TRUE(c.has_size && c.depth_scale_given && c.readout_given);
  EXPECT_TRUE(
      says(read_text("fx: 525\nshutter: rolling\n", c, "a.yaml"), "'shutter' is not known; the keys are fx"));
  EXPECT_TRUE(says(read_text("fx: {a: 1}\n", c, "a.yaml"), "'fx' needs a number"));
  EXPECT_FALSE(read_text(std::string(100'000, '['), c, "a.yaml").ok());
  EXPECT_FALSE(read_text("a: &a [*a, *a]\nK: *a\n", c, "a.yaml").ok());
}

TEST(Calibration, FindsTheFileInAFolder) {
  const TemporaryFolder folder;
  EXPECT_FALSE(calibration_file_in(folder.path()).has_value());
  for (const char* name : {"camera.yaml", "calibration.yaml", "calibration.txt"}) {
    write_file(folder / name, "");
    EXPECT_EQ(calibration_file_in(folder.path()), folder / name);
  }
}

std::string camera_info(const std::string& model, const std::string& coefficients) {
  return "width: 640\nheight: 480\nK: [500, 0, 320, 0, 501, 240, 0, 0, 1]\ndistortion_model: " + model +
         "\nD: [" + coefficients + "]\n";
}

// In the form that the drivers of Azure Kinect and Orbbec cameras and of RealSense's fisheyes publish.
TEST(Calibration, ReadsRationalAndEquidistantCameraInfo) {
  Calibration c;
  ASSERT_TRUE(read_text(camera_info("rational_polynomial", "1, 2, 3, 4, 5, 6, 7, 8"), c, "a.yaml").ok());
  const Distortion& lens = c.camera.distortion;
  EXPECT_TRUE(lens.k1 == 1 && lens.p1 == 3 && lens.p2 == 4 && lens.k3 == 5 && lens.k4 == 6 && lens.k6 == 8);
  EXPECT_EQ(lens.model, LensModel::kRational);
  for (const char* name : {"equidistant", "fisheye"}) {
    ASSERT_TRUE(read_text(camera_info(name, "0.1, 0.2, 0.3, 0.4"), c, "a.yaml").ok()) << name;
    EXPECT_EQ(lens.model, LensModel::kEquidistant);
    EXPECT_TRUE(lens.k1 == 0.1 && lens.k2 == 0.2 && lens.k3 == 0.3 && lens.k4 == 0.4 && lens.p1 == 0);
  }
}

TEST(Calibration, ReadsLensesByKeys) {
  const std::string pinhole = "fx: 500\nfy: 501\ncx: 320\ncy: 240\n";
  const std::string rational = pinhole + "k1: 0.1\nk6: 0.6\np2: 0.2\n";
  for (const char* name : {"calibration.txt", "calibration.yaml"}) {
    Calibration c;
    const Distortion& lens = c.camera.distortion;
    ASSERT_TRUE(read_text(rational, c, name).ok());
    EXPECT_TRUE(lens.k1 == 0.1 && lens.k6 == 0.6 && lens.p2 == 0.2 && lens.model == LensModel::kRational);
    ASSERT_TRUE(read_text(rational + "distortion_model: rational_polynomial\n", c, name).ok());
    ASSERT_TRUE(read_text(pinhole + "distortion_model: equidistant\nk1: 0.1\nk4: 0.4\n", c, name).ok());
    EXPECT_TRUE(lens.k1 == 0.1 && lens.k4 == 0.4 && lens.model == LensModel::kEquidistant);
    EXPECT_TRUE(
        says(read_text(rational + "distortion_model: plumb_bob\n", c, name), "plumb_bob has no k4 k5 k6"));
    const Status unknown = read_text(pinhole + "distortion_model: ftheta\n", c, name);
    EXPECT_EQ(unknown.code(), StatusCode::kUnsupported);
    EXPECT_TRUE(says(unknown, "'ftheta' is not supported, only plumb_bob, rational_polynomial and equi"));
  }
  Calibration c;
  ASSERT_TRUE(read_text("500 501 320 240 1000\ndistortion_model equidistant\n", c).ok());
  EXPECT_EQ(c.camera.distortion.model, LensModel::kEquidistant);
  EXPECT_TRUE(says(read_text(pinhole + "distortion_model\n", c), "'distortion_model' needs plumb_bob"));
  EXPECT_TRUE(says(read_text(pinhole + "distortion_model fisheye\ndistortion_model fisheye\n", c),
                   "'distortion_model' is said twice"));
}

TEST(Calibration, RoundTripsLenses) {
  Calibration written;
  written.camera.pinhole = {500, 501, 320, 240};
  for (const Distortion& lens :
       {Distortion{0.1, 0.2, 1e-3, -1e-3, 0.3, 1 / 3.0, -0.1, 1e-9}, Distortion{.k6 = 0.1},
        Distortion{.model = LensModel::kEquidistant},
        Distortion{.k1 = 0.1, .k2 = -0.2, .k3 = 0.3, .k4 = 1 / 3.0, .model = LensModel::kEquidistant}}) {
    written.camera.distortion = lens;
    for (const std::string& text : {calibration_text(written), calibration_lines(written)}) {
      Calibration c;
      const Status status = read_text(text, c);
      ASSERT_TRUE(status.ok()) << status.message() << text;
      const Distortion& got = c.camera.distortion;
      EXPECT_TRUE(got.model == lens.model && got.k1 == lens.k1 && got.k2 == lens.k2 && got.p1 == lens.p1 &&
                  got.p2 == lens.p2 && got.k3 == lens.k3 && got.k4 == lens.k4 && got.k5 == lens.k5 &&
                  got.k6 == lens.k6)
          << text;
      EXPECT_EQ(calibration_text(c), calibration_text(written));
    }
    Calibration c;
    EXPECT_TRUE(read_text(calibration_lines(written), c, "a.yaml").ok()) << "the same as YAML";
    EXPECT_EQ(c.camera.distortion.k4, lens.k4);
  }
}

TEST(Calibration, ReadsASeparateDepthCamera) {
  const std::string colour = "525 525 319.5 239.5 1000\n";
  const std::string pinhole = "depth_fx 360\ndepth_fy 361\ndepth_cx 159.5\ndepth_cy 119.5\n";
  Calibration c;
  ASSERT_TRUE(read_text(colour, c).ok());
  EXPECT_FALSE(c.depth_camera.known);
  ASSERT_TRUE(read_text(colour + pinhole + "depth_tx 0.025\ndepth_ty 0.001\ndepth_tz 0\n", c).ok());
  EXPECT_TRUE(c.depth_camera.known && c.depth_camera.pinhole.fy == 361 && c.depth_camera.tx == 0.025);
  EXPECT_TRUE(c.validate(640, 480).ok());
  for (const std::string& text : {calibration_text(c), calibration_lines(c)}) {
    Calibration again;
    ASSERT_TRUE(read_text(text, again).ok()) << text;
    EXPECT_TRUE(again.depth_camera.known && again.depth_camera.tx == 0.025 && again.depth_camera.qw == 1);
    EXPECT_EQ(calibration_text(again), calibration_text(c));
  }
  ASSERT_TRUE(read_text(std::string(kCameraInfo) + "depth_fx: 360\ndepth_fy: 360\ndepth_cx: 1\ndepth_cy: 2\n",
                        c, "a.yaml")
                  .ok());
  EXPECT_TRUE(c.depth_camera.known);
  EXPECT_TRUE(
      says(read_text(colour + "depth_fx 360\n", c), "depth_fx, depth_fy, depth_cx and depth_cy go together"));
  EXPECT_TRUE(says(read_text(colour + "depth_qx 0.1\n", c), "depth_qy, depth_qz and depth_qw go together"));
  ASSERT_TRUE(read_text(colour + pinhole + "depth_tx 0.1\n", c).ok()) << "an offset needs one number";
  EXPECT_TRUE(c.depth_camera.tx == 0.1 && c.depth_camera.ty == 0 && !c.depth_camera.as_colour);
  ASSERT_TRUE(read_text(colour + pinhole + "depth_qx 0\ndepth_qy 0\ndepth_qz 0\ndepth_qw 0.5\n", c).ok());
  EXPECT_TRUE(says(c.validate(640, 480), "depth_qw must have the length 1"));
  ASSERT_TRUE(read_text(colour + pinhole + "depth_tx 25\ndepth_ty 0\ndepth_tz 0\n", c).ok());
  EXPECT_TRUE(says(c.validate(640, 480), "are metres"));
  ASSERT_TRUE(read_text(colour + "depth_fx -1\ndepth_fy 1\ndepth_cx 1\ndepth_cy 1\n", c).ok());
  EXPECT_TRUE(says(c.validate(640, 480), "fx and fy must be numbers from 1 to 100000"));
}

// Two cameras of the same kind on one mount.
TEST(Calibration, ReadsADepthOffsetWithoutPinhole) {
  Calibration c;
  ASSERT_TRUE(read_text("525 525 319.5 239.5 1000\ndepth_tx -0.025\n", c).ok());
  EXPECT_TRUE(c.depth_camera.known && c.depth_camera.as_colour && c.depth_camera.tx == -0.025);
  EXPECT_TRUE(c.validate(640, 480).ok());
  for (const std::string& text : {calibration_text(c), calibration_lines(c)}) {
    EXPECT_EQ(text.find("depth_fx"), std::string::npos) << text;
    Calibration again;
    ASSERT_TRUE(read_text(text, again).ok()) << text;
    EXPECT_TRUE(again.depth_camera.as_colour && again.depth_camera.tx == -0.025);
    EXPECT_EQ(calibration_text(again), calibration_text(c));
  }
  ASSERT_TRUE(read_text("525 525 319.5 239.5 1000\ndepth_tx -25\n", c).ok());
  EXPECT_TRUE(says(c.validate(640, 480), "are metres, at most 1 m"));
}

TEST(Calibration, RejectsOtherDistortionModels) {
  Calibration c;
  const Status status = read_text(camera_info("omnidirectional", "0.1"), c, "rgb.yaml");
  EXPECT_EQ(status.code(), StatusCode::kUnsupported);
  EXPECT_TRUE(says(status, "'omnidirectional' is not supported, only plumb_bob, rational_polynomial and "))
      << status.message();
  EXPECT_EQ(read_text(camera_info("equidistant", "0.1, 0.2"), c, "rgb.yaml").code(), StatusCode::kDamaged);
  EXPECT_TRUE(says(read_text(camera_info("plumb_bob", "1, 2, 3, 4, 5, 6, 7, 8"), c, "rgb.yaml"),
                   "8 are rational_polynomial's"));
}

TEST(Calibration, RejectsBrokenYaml) {
  Calibration c;
  EXPECT_EQ(read_text("camera_matrix: [1, 2", c, "rgb.yaml").code(), StatusCode::kDamaged);
  EXPECT_EQ(read_text("just words\n", c, "rgb.yaml").code(), StatusCode::kDamaged);
  EXPECT_EQ(read_text("camera_matrix: {data: [1, 2, x, 0, 0, 0, 0, 0, 0]}\n", c, "rgb.yaml").code(),
            StatusCode::kDamaged);
}

TEST(Calibration, KnowsBuiltinNames) {
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
  // The page of 7-Scenes states only the depth camera; the colour camera is reported as a guess.
  Calibration seven;
  ASSERT_TRUE(builtin_calibration("7scenes", seven).ok());
  EXPECT_EQ(seven.camera.pinhole.fx, 525);
  EXPECT_TRUE(seven.depth_camera.known && seven.depth_camera.pinhole.fx == 585 &&
              seven.depth_camera.tx == -0.025);
  ASSERT_EQ(seven.assumptions().size(), 1u);
  EXPECT_NE(seven.assumptions()[0].find("a guess, because its page gives only depth's: 525 px"),
            std::string::npos)
      << seven.assumptions()[0];
  EXPECT_NE(seven.assumptions()[0].find("25 mm beside"), std::string::npos) << seven.assumptions()[0];
}

TEST(Calibration, AcceptsANameOrAFile) {
  Calibration c;
  ASSERT_TRUE(named_calibration("tum-fr3", c).ok());
  EXPECT_EQ(c.camera.pinhole.fx, 535.4);
  const TemporaryFolder folder;
  write_file(folder / "tum-fr3", "525 526 319.5 239.5\n");
  ASSERT_TRUE(named_calibration((folder / "tum-fr3").string(), c).ok()) << "a file of a camera's name";
  EXPECT_EQ(c.camera.pinhole.fy, 526);
  const Status neither = named_calibration((folder / "tum-fr9").string(), c);
  EXPECT_EQ(neither.code(), StatusCode::kNotFound);
  EXPECT_TRUE(says(neither, "tum-fr9")) << neither.message();
}

}  // namespace
}  // namespace plvo
