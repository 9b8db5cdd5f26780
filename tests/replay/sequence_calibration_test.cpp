// SPDX-License-Identifier: Apache-2.0
// The calibration of a recording for which the user names none, and the messages about it.
#include "plvo/replay/calibration/sequence_calibration.hpp"

#include <gtest/gtest.h>

#include <string>

#include "says.hpp"
#include "temporary_folder.hpp"

namespace plvo {
namespace {

namespace fs = std::filesystem;
using test::says;
using test::TemporaryFolder;
using test::write_file;

bool has_text(const std::string& text, std::string_view words) {
  return text.find(words) != std::string::npos;
}

class SequenceCalibration : public ::testing::Test {
 protected:
  Status find(const fs::path& folder) { return sequence_calibration(folder, calibration_, guess_); }
  fs::path make(const char* name) const {
    fs::create_directories(folder_ / name);
    return folder_ / name;
  }

  TemporaryFolder folder_;
  Calibration calibration_;
  std::string guess_;
};

TEST_F(SequenceCalibration, FindsFilesOfOtherPrograms) {
  const std::string matrix = "585 0 320\n0 586 240\n0 0 1\n";
  for (const char* name : {"camera-intrinsics.txt", "cam_K.txt", "intrinsics.txt"}) {
    const TemporaryFolder folder;
    write_file(folder / name, matrix);
    ASSERT_TRUE(find(folder.path()).ok()) << name;
    EXPECT_EQ(calibration_.camera.pinhole.fy, 586) << name;
    EXPECT_EQ(guess_, "");
    EXPECT_EQ(calibration_files_in(folder.path()), std::vector<fs::path>{folder / name});
  }
  for (const char* name : {"camera_intrinsic.json", "intrinsic.json"}) {
    const TemporaryFolder folder;
    write_file(folder / name, R"({"width":640,"height":480,"intrinsic_matrix":[1,0,0,0,587,0,3,4,1]})");
    ASSERT_TRUE(find(folder.path()).ok()) << name;
    EXPECT_EQ(calibration_.camera.pinhole.fy, 587) << name;
  }
  for (const char* name : {"camchain.yaml", "sensor.yaml", "cam0/sensor.yaml"}) {
    const TemporaryFolder folder;
    fs::create_directories(folder / "cam0");
    write_file(folder / name, "intrinsics: [500, 588, 320, 240]\n");
    ASSERT_TRUE(find(folder.path()).ok()) << name;
    EXPECT_EQ(calibration_.camera.pinhole.fy, 588) << name;
  }
  // 3DMatch has one file for all sequences of a scene.
  write_file(folder_ / "camera-intrinsics.txt", matrix);
  ASSERT_TRUE(find(make("seq-01")).ok());
  EXPECT_EQ(calibration_.camera.pinhole.fx, 585);
}

TEST_F(SequenceCalibration, UsesTheOnlySettingsFileWithAWarning) {
  const std::string settings = "Camera.fx: 517.3\nCamera.fy: 516.5\nCamera.cx: 318.6\nCamera.cy: 255.3\n";
  write_file(folder_ / "TUM1.yaml", settings);
  ASSERT_TRUE(find(folder_.path()).ok());
  EXPECT_EQ(calibration_.camera.pinhole.fx, 517.3);
  EXPECT_TRUE(has_text(guess_, "TUM1.yaml, the folder's only settings, is taken for it")) << guess_;
  EXPECT_EQ(calibration_files_in(folder_.path()), std::vector<fs::path>{folder_ / "TUM1.yaml"});
  // With two files the choice is ambiguous.
  write_file(folder_ / "other.yaml", settings);
  EXPECT_EQ(find(folder_.path()).code(), StatusCode::kNotFound);
  EXPECT_TRUE(calibration_files_in(folder_.path()).empty());
  // A file that is not a calibration is not used, and the message names it.
  fs::remove(folder_ / "other.yaml");
  write_file(folder_ / "TUM1.yaml", "speed: fast\n");
  const Status status = find(folder_.path());
  EXPECT_EQ(status.code(), StatusCode::kNotFound);
  EXPECT_TRUE(says(status, "has no calibration file; ")) << status.message();
  EXPECT_TRUE(says(status, "TUM1.yaml: 'speed' is not known")) << status.message();
}

TEST_F(SequenceCalibration, RecognisesTumNamesAndHintsAtSimilarOnes) {
  for (const char number : {'1', '2', '3'}) {
    const std::string model = std::string("tum-fr") + number;
    ASSERT_TRUE(find(make((std::string("rgbd_dataset_freiburg") + number + "_xyz").c_str()) / "").ok());
    Calibration tum;
    ASSERT_TRUE(builtin_calibration(model, tum).ok());
    EXPECT_EQ(calibration_.camera.pinhole.cx, tum.camera.pinhole.cx);
    EXPECT_TRUE(has_text(guess_, "by its name it is of the camera " + model)) << guess_;
    for (const std::string& name :
         {std::string("fr") + number + "_kitchen", std::string("my_freiburg") + number + "_flat"}) {
      const Status status = find(make(name.c_str()));
      EXPECT_EQ(status.code(), StatusCode::kNotFound) << name;
      EXPECT_TRUE(says(status, "if it is TUM's, as its name may say: --camera-model " + model))
          << status.message();
    }
  }
  const Status status = find(make("kitchen"));
  EXPECT_EQ(status.code(), StatusCode::kNotFound);
  EXPECT_FALSE(says(status, "TUM")) << status.message();
}

TEST_F(SequenceCalibration, ReportsWhatPlainTumNumbersOmit) {
  const auto missing = [&](const char* name, const char* numbers) {
    write_file(folder_ / "calibration.txt", numbers);
    EXPECT_TRUE(read_calibration(folder_ / "calibration.txt", calibration_).ok()) << numbers;
    return missing_of_tum(folder_ / name, calibration_);
  };
  const std::string all = missing("sequence", "517.3 516.5 318.6 255.3 5000");
  EXPECT_TRUE(has_text(all, "by its numbers this is TUM's camera tum-fr1")) << all;
  EXPECT_TRUE(has_text(all,
                       "does not say: the lens, the rolling shutter, when depth is exposed, the "
                       "errors of the stamps; --camera-model tum-fr1 says it"))
      << all;
  const std::string lens = missing(
      "sequence", "517.306408 516.469215 318.643040 255.313989 5000 0.262 -0.953 -0.005 0.0026 1.163");
  EXPECT_TRUE(has_text(lens, "does not say: the rolling shutter, when depth is exposed, the errors")) << lens;
  EXPECT_TRUE(has_text(missing("sequence", "520.9 521.0 325.1 249.7"), "tum-fr2"));
  EXPECT_TRUE(has_text(missing("sequence", "535.4 539.2 320.1 247.6 5000"), "tum-fr3"));
  // The driver's numbers identify no camera, but the name of the recording does; so does that of a bag.
  for (const char* name : {"rgbd_dataset_freiburg1_desk", "rgbd_dataset_freiburg1_desk.bag"})
    EXPECT_TRUE(
        has_text(missing(name, "525 525 319.5 239.5 5000"), "by its name this is TUM's camera tum-fr1"));
  EXPECT_EQ(missing("fr1_desk", "525 525 319.5 239.5 5000"), "") << "a name like it is none of TUM's";
  EXPECT_EQ(missing("sequence", "518 516.5 318.6 255.3 5000"), "");
  for (const char* model : {"tum-fr1", "tum-fr2", "tum-fr3"}) {
    ASSERT_TRUE(builtin_calibration(model, calibration_).ok());
    EXPECT_EQ(missing_of_tum("sequence", calibration_), "") << model;
  }
}

}  // namespace
}  // namespace plvo
