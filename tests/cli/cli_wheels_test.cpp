// SPDX-License-Identifier: Apache-2.0
// `plvo run --wheels` on what `plvo simulate --robot` writes: it bridges a covered lens, and says what is
// wrong.
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "plvo_command.hpp"

namespace plvo {
namespace {

constexpr const char* kRobotCamera = " --base-camera 0.2 0 0.5 -0.5 0.5 -0.5 0.5 ";

class CliWheels : public test::PlvoCommand {
 protected:
  static std::string recording() {
    static const test::TemporaryFolder folder;
    static const bool made = [] {
      const auto result =
          plvo("simulate --robot --scene hall --size 320x240 --frames 45 --covered 15:30 --quiet --out " +
               (folder / "sequence").string());
      EXPECT_EQ(result.exit_code, 0) << result.err;
      return true;
    }();
    EXPECT_TRUE(made);
    return (folder / "sequence").string();
  }
  static std::string wheels() { return recording() + "/wheel_odometry.txt"; }
  nlohmann::json summary(const std::string& options) const {
    const auto result = plvo("run " + recording() + " --quiet --json " + path("s.json") + ' ' + options);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(result.err, "");
    return nlohmann::json::parse(test::read_file(folder_ / "s.json"));
  }
};

TEST_F(CliWheels, BridgeACoveredLens) {
  const nlohmann::json without = summary(""), with = summary("--wheels " + wheels() + kRobotCamera);
  EXPECT_GE(without["lost"], 15);
  EXPECT_EQ(with["lost"], 0);
  EXPECT_GE(with["predicted"], 15);
  EXPECT_LT(with["evaluation"]["ate_m"]["rmse"], 0.02) << "half a second at half a metre per second";
  EXPECT_LT(with["evaluation"]["nees_pose"]["mean"], 12) << "as the covariance says";
  // Wheels that are said to be poor count for less.
  const nlohmann::json poor = summary("--wheels-error 0.5 --wheels " + wheels() + kRobotCamera);
  EXPECT_LT(poor["evaluation"]["nees_pose"]["mean"], with["evaluation"]["nees_pose"]["mean"]);
  const nlohmann::json both = summary("--imu --wheels " + wheels() + kRobotCamera);
  EXPECT_GE(both["predicted"], 15);
  EXPECT_LT(both["evaluation"]["ate_m"]["rmse"], 0.02);
}

// An accelerometer alone says nothing of the turn: that of the wheels counts, beside gravity.
TEST_F(CliWheels, TurnTheCameraBesideAnAccelerometerAlone) {
  const std::filesystem::path recorded = recording(), copy = folder_ / "no_gyro";
  std::filesystem::copy(recorded, copy, std::filesystem::copy_options::recursive);
  std::filesystem::remove(copy / "gyroscope.txt");
  const auto turn_of = [&](const std::string& options) {
    const auto result = plvo("run " + copy.string() + " --quiet --json " + path("s.json") + " --wheels " +
                             wheels() + kRobotCamera + options);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    const nlohmann::json json = nlohmann::json::parse(test::read_file(folder_ / "s.json"));
    EXPECT_GE(json["predicted"], 15);
    return json["evaluation"]["rpe"][0]["rotation_deg"]["rmse"].get<double>();
  };
  EXPECT_LT(turn_of("--imu"), 2.5 * turn_of(""));
}

TEST_F(CliWheels, TellWhatLooksWrong) {
  const auto told = [&](const std::string& text, const std::string& words) {
    test::write_file(folder_ / "w.txt", text);
    const auto result = plvo("run " + recording() + " --frames 4 --quiet --out " + path("t") + " --wheels " +
                             path("w.txt") + kRobotCamera);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_NE(result.err.find(words), std::string::npos) << result.err;
  };
  told("1 0 0 0\n2 0 0 0\n", "the wheels have no samples at the stamps of the images");
  told("1599999999 500 0 0\n1600000009 500 0 0\n", "up to 500 m/s");
  told("1599999999 0 0 -57\n1600000009 0 0 0\n", "up to 57 rad/s");
  told("1599999999 0 0 0\n1599999999 0 0 0\n1600000009 0 0 0\n", "1 samples of the wheels left out");
}

TEST_F(CliWheels, RefuseWhatDoesNotApply) {
  const std::string run = "run " + recording() + ' ';
  expect_refused(plvo(run + "--wheels " + wheels()), 2, "--wheels: needs --base-camera");
  expect_refused(plvo(run + "--wheels-error 0.1"), 2, "is for --wheels");
  expect_refused(plvo(run + "--wheels-error 2 --wheels " + wheels() + kRobotCamera), 2, "--wheels-error");
  expect_refused(plvo("run --camera sim --wheels " + wheels() + kRobotCamera), 2, "plvo simulate --robot");
  expect_refused(plvo(run + "--wheels " + path("none.txt") + kRobotCamera), 1, "none.txt");
  expect_refused(plvo(run + "--out " + wheels() + " --wheels " + wheels() + kRobotCamera), 2,
                 "wheel_odometry.txt");
  test::write_file(folder_ / "w.txt", "1 2 3\n");
  expect_refused(plvo(run + "--wheels " + path("w.txt") + kRobotCamera), 1, "line 1: must have 4 columns");
}

}  // namespace
}  // namespace plvo
