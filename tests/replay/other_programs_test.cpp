// SPDX-License-Identifier: Apache-2.0
// Calibrations in the formats of Kalibr, EuRoC, ORB-SLAM and Open3D.
#include <gtest/gtest.h>

#include <string>

#include "plvo/replay/calibration/calibration.hpp"
#include "says.hpp"
#include "temporary_folder.hpp"

namespace plvo {
namespace {

using test::says;
using test::TemporaryFolder;
using test::write_file;

Status read_as(const std::string& text, Calibration& calibration, const char* name = "camera.yaml") {
  const TemporaryFolder folder;
  write_file(folder / name, text);
  return read_calibration(folder / name, calibration);
}

// Written as by kalibr_calibrate_cameras, for a sensor whose depth camera comes first.
const std::string kCamchain =
    "cam0:\n  cam_overlaps: [1]\n  camera_model: pinhole\n"
    "  distortion_coeffs: [0.01, -0.02, 0.0003, -0.0004]\n  distortion_model: radtan\n"
    "  intrinsics: [385.1, 385.2, 320.3, 241.4]\n  resolution: [640, 480]\n"
    "  rostopic: /camera/infra1/image_rect_raw\n"
    "cam1:\n  T_cn_cnm1:\n  - [1.0, 0.0, 0.0, 0.015]\n  - [0.0, 1.0, 0.0, 0.0]\n"
    "  - [0.0, 0.0, 1.0, 0.0]\n  - [0.0, 0.0, 0.0, 1.0]\n  cam_overlaps: [0]\n  camera_model: pinhole\n"
    "  distortion_coeffs: [0.11, -0.22, 0.0011, -0.0022]\n  distortion_model: radtan\n"
    "  intrinsics: [615.1, 615.2, 318.3, 243.4]\n  resolution: [640, 480]\n"
    "  rostopic: /camera/color/image_raw\n";

TEST(OtherPrograms, ReadsKalibrAndFindsColourByTopic) {
  Calibration c;
  const Status status = read_as(kCamchain, c, "camchain.yaml");
  ASSERT_TRUE(status.ok()) << status.message();
  EXPECT_EQ(c.camera.pinhole.fx, 615.1);
  EXPECT_EQ(c.camera.pinhole.fy, 615.2);
  EXPECT_EQ(c.camera.pinhole.cx, 318.3);
  EXPECT_EQ(c.camera.pinhole.cy, 243.4);
  const Distortion& lens = c.camera.distortion;
  EXPECT_TRUE(lens.k1 == 0.11 && lens.k2 == -0.22 && lens.p1 == 0.0011 && lens.p2 == -0.0022 && lens.k3 == 0);
  EXPECT_TRUE(c.has_size && c.camera.width == 640 && c.camera.height == 480);
  EXPECT_EQ(c.guess, "");
  EXPECT_FALSE(c.depth_scale_given || c.readout_given || c.depth_camera.known);
  // Keys of the sensor may stand beside Kalibr's.
  ASSERT_TRUE(read_as(kCamchain + "depth_scale: 1000\nreadout_s: 0.02\ndepth_tx: -0.015\n", c).ok());
  EXPECT_TRUE(c.depth_units_per_metre == 1000 && c.camera.readout_s == 0.02);
  EXPECT_TRUE(c.depth_camera.known && c.depth_camera.as_colour && c.depth_camera.tx == -0.015);
}

TEST(OtherPrograms, WarnsIfKalibrDoesNotIdentifyColour) {
  std::string text = kCamchain;
  text.replace(text.find("color/image_raw"), 5, "other");
  Calibration c;
  ASSERT_TRUE(read_as(text, c).ok());
  EXPECT_EQ(c.camera.pinhole.fx, 385.1);
  const std::vector<std::string> assumed = c.assumptions();
  ASSERT_FALSE(assumed.empty());
  EXPECT_NE(
      assumed[0].find("has 2 cameras, and no rostopic says which took the colour images: cam0 is taken"),
      std::string::npos)
      << assumed[0];
  // A single camera needs no topic.
  ASSERT_TRUE(read_as(kCamchain.substr(0, kCamchain.find("cam1:")), c).ok());
  EXPECT_EQ(c.camera.pinhole.fx, 385.1);
  EXPECT_EQ(c.guess, "");
}

// The benchmark's file for cam0, with its comments.
const std::string kEuroc =
    "# General sensor definitions.\nsensor_type: camera\ncomment: VI-Sensor cam0 (MT9M034)\n\n"
    "T_BS:\n  cols: 4\n  rows: 4\n  data: [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0,\n"
    "         0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0]\n\nrate_hz: 20\nresolution: [752, 480]\n"
    "camera_model: pinhole\nintrinsics: [458.654, 457.296, 367.215, 248.375] #fu, fv, cu, cv\n"
    "distortion_model: radial-tangential\n"
    "distortion_coefficients: [-0.28340811, 0.07395907, 0.00019359, 1.76187114e-05]\n";

TEST(OtherPrograms, ReadsEuroc) {
  Calibration c;
  for (const std::string& text : {kEuroc, "%YAML:1.0\n" + kEuroc}) {
    const Status status = read_as(text, c, "sensor.yaml");
    ASSERT_TRUE(status.ok()) << status.message();
    EXPECT_EQ(c.camera.pinhole.fy, 457.296);
    EXPECT_EQ(c.camera.distortion.k1, -0.28340811);
    EXPECT_EQ(c.camera.distortion.p2, 1.76187114e-05);
    EXPECT_TRUE(c.camera.width == 752 && c.camera.height == 480);
  }
}

TEST(OtherPrograms, MapsNamesOfLensesAndModels) {
  const std::string camera = "intrinsics: [400, 401, 320, 240]\n";
  Calibration c;
  for (const char* name : {"equidistant", "equi"}) {
    ASSERT_TRUE(
        read_as(camera + "distortion_model: " + name + "\ndistortion_coeffs: [1, 2, 3, 4]\n", c).ok());
    EXPECT_EQ(c.camera.distortion.model, LensModel::kEquidistant);
    EXPECT_EQ(c.camera.distortion.k4, 4);
  }
  for (const char* lens :
       {"", "distortion_model: none\ndistortion_coeffs: []\n", "distortion_model: radtan\n"}) {
    ASSERT_TRUE(read_as(camera + lens, c).ok()) << lens;
    EXPECT_TRUE(c.camera.distortion.is_zero());
    EXPECT_FALSE(c.has_size);
  }
  const auto unsupported = [&](const std::string& text, std::string_view words) {
    const Status status = read_as(text, c);
    EXPECT_EQ(status.code(), StatusCode::kUnsupported) << text;
    EXPECT_TRUE(says(status, words)) << status.message();
  };
  unsupported(camera + "distortion_model: fov\ndistortion_coeffs: [0.9]\n", "distortion model 'fov' is not");
  for (const char* model : {"omni", "ds", "eucm"})
    unsupported("cam0:\n  camera_model: " + std::string(model) + "\n  intrinsics: [1, 2, 3, 4, 5]\n",
                "camera_model '" + std::string(model) + "' is not supported, only pinhole");
  const auto damaged = [&](const std::string& text, std::string_view words) {
    const Status status = read_as(text, c);
    EXPECT_EQ(status.code(), StatusCode::kDamaged) << text;
    EXPECT_TRUE(says(status, words)) << status.message();
  };
  damaged("intrinsics: [400, 401, 320]\n", "intrinsics must have 4 numbers, fx fy cx cy");
  damaged("intrinsics: [400, x, 320, 240]\n", "bad conversion");
  damaged(camera + "resolution: 640\n", "resolution must be [width, height]");
  damaged(camera + "resolution: [640, 0]\n", "whole numbers of pixels");
  damaged(camera + "distortion_model: radtan\ndistortion_coeffs: [1, 2]\n", "distortion coefficients");
}

// ORB-SLAM2's TUM1.yaml.
const std::string kOrbSlam2 =
    "%YAML:1.0\n\n#-----\n# Camera Parameters. Adjust them!\n#-----\n\n"
    "# Camera calibration and distortion parameters (OpenCV) \nCamera.fx: 517.306408\nCamera.fy: 516.469215\n"
    "Camera.cx: 318.643040\nCamera.cy: 255.313989\n\nCamera.k1: 0.262383\nCamera.k2: -0.953104\n"
    "Camera.p1: -0.005358\nCamera.p2: 0.002628\nCamera.k3: 1.163314\n\nCamera.width: 640\nCamera.height: "
    "480\n\n"
    "# Camera frames per second \nCamera.fps: 30.0\n\nCamera.bf: 40.0\nCamera.RGB: 1\nThDepth: 40.0\n"
    "DepthMapFactor: 5000.0\nORBextractor.nFeatures: 1000\nViewer.KeyFrameSize: 0.05\n";

TEST(OtherPrograms, ReadsOrbSlam) {
  Calibration c, tum;
  const Status status = read_as(kOrbSlam2, c, "TUM1.yaml");
  ASSERT_TRUE(status.ok()) << status.message();
  ASSERT_TRUE(builtin_calibration("tum-fr1", tum).ok());
  EXPECT_EQ(c.camera.pinhole.fx, tum.camera.pinhole.fx);
  EXPECT_EQ(c.camera.pinhole.cy, tum.camera.pinhole.cy);
  EXPECT_EQ(c.camera.distortion.p1, tum.camera.distortion.p1);
  EXPECT_EQ(c.camera.distortion.k3, tum.camera.distortion.k3);
  EXPECT_TRUE(c.depth_scale_given && c.depth_units_per_metre == 5000);
  EXPECT_TRUE(c.has_size && c.camera.width == 640);
  // ORB-SLAM3's format, with a matrix of OpenCV.
  const std::string third =
      "%YAML:1.0\n---\nFile.version: \"1.0\"\nCamera.type: \"PinHole\"\nCamera1.fx: 600.5\nCamera1.fy: 601\n"
      "Camera1.cx: 320\nCamera1.cy: 240\nCamera1.k1: 0.1\nCamera1.k2: 0\nCamera1.p1: 0\nCamera1.p2: 0\n"
      "Camera.width: 640\nCamera.height: 480\nRGBD.DepthMapFactor: 1000.0\n"
      "IMU.T_b_c1: !!opencv-matrix\n   rows: 4\n   cols: 4\n   dt: f\n   data: [1, 0, 0, 0]\n";
  ASSERT_TRUE(read_as(third, c).ok());
  EXPECT_TRUE(c.camera.pinhole.fx == 600.5 && c.camera.distortion.k1 == 0.1);
  EXPECT_EQ(c.depth_units_per_metre, 1000);
  std::string other = third;
  other.replace(other.find("PinHole"), 7, "Rectified");
  ASSERT_TRUE(read_as(other, c).ok());
  EXPECT_TRUE(c.camera.distortion.is_zero()) << "rectified images have no lens";
  other = third + "Camera1.k3: 0.3\nCamera1.k4: 0.4\n";
  other.replace(other.find("PinHole"), 7, "KannalaBrandt8");
  ASSERT_TRUE(read_as(other, c).ok());
  EXPECT_TRUE(c.camera.distortion.model == LensModel::kEquidistant && c.camera.distortion.k4 == 0.4);
  other.replace(other.find("KannalaBrandt8"), 14, "Equirectangular");
  EXPECT_EQ(read_as(other, c).code(), StatusCode::kUnsupported);
  EXPECT_TRUE(says(read_as("Camera.fx: 500\n", c), "fx, fy, cx and cy must all be given"));
  EXPECT_TRUE(says(read_as("Camera.fx: many\n", c), "'fx' needs a number"));
}

// Written as by Open3D's PinholeCameraIntrinsic, with tabs.
const std::string kOpen3d =
    "{\n\t\"height\" : 480,\n\t\"intrinsic_matrix\" : "
    "\n\t[\n\t\t615.19518999999997,\n\t\t0.0,\n\t\t0.0,\n\t\t"
    "0.0,\n\t\t615.25,\n\t\t0.0,\n\t\t298.442688,\n\t\t247.519196,\n\t\t1.0\n\t],\n\t\"width\" : 640\n}";

TEST(OtherPrograms, ReadsOpen3d) {
  Calibration c;
  for (const char* name : {"camera_intrinsic.json", "calibration.txt"}) {  // the content tells the format
    const Status status = read_as(kOpen3d, c, name);
    ASSERT_TRUE(status.ok()) << status.message();
    EXPECT_EQ(c.camera.pinhole.fx, 615.19519);
    EXPECT_EQ(c.camera.pinhole.fy, 615.25);
    EXPECT_EQ(c.camera.pinhole.cx, 298.442688);
    EXPECT_EQ(c.camera.pinhole.cy, 247.519196);
    EXPECT_TRUE(c.has_size && c.camera.width == 640 && c.camera.height == 480);
  }
  EXPECT_TRUE(says(read_as("{\"intrinsic_matrix\": [615, 0, 298, 0, 615, 247, 0, 0, 1]}", c, "a.json"),
                   "column by column: fx 0 0 0 fy 0 cx cy 1"));
  EXPECT_FALSE(read_as("{\"intrinsic_matrix\": {}}", c, "a.json").ok());
  EXPECT_FALSE(read_as("{\"intrinsic_matrix\": [615, 0", c, "a.json").ok());
}

}  // namespace
}  // namespace plvo
