// SPDX-License-Identifier: Apache-2.0
// `plvo calibrate` as the user runs it.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "command.hpp"
#include "plvo/replay/calibration/calibration.hpp"
#include "plvo_binary.hpp"
#include "tiny_sequence.hpp"
#include "turning_hand.hpp"

namespace plvo {
namespace {

using test::CommandResult;
using test::kPlvo;
using test::run_command;
using test::TemporaryFolder;

TEST(CliCalibrate, RecoversTheDelayOfDepthFromTheRecordingAlone) {
  const TemporaryFolder folder;
  const std::string walk = (folder / "walk").string(), yaml = (folder / "camera.yaml").string();
  test::write_file(folder / "hand.txt", test::turning_hand(2.2));
  const CommandResult made = run_command(
      kPlvo + " simulate --quiet --frames 60 --size 320x240 --scene desk --depth-delay 0.012 --out " + walk +
      " --trajectory " + (folder / "hand.txt").string());
  ASSERT_EQ(made.exit_code, 0) << made.err;
  // The lens is known, and nothing of depth's time.
  const CommandResult r =
      run_command(kPlvo + " calibrate " + walk +
                  " --find delay --fx 262.5 --fy 262.5 --cx 159.5 --cy 119.5 --depth-scale 5000 "
                  "--readout 0 --json - --report " +
                  (folder / "page.html").string() + " --out " + yaml);
  ASSERT_EQ(r.exit_code, 0) << r.err;
  EXPECT_EQ(r.err, "");
  const auto json = nlohmann::json::parse(r.out);
  EXPECT_NEAR(json["depth_delay_s"]["value"].get<double>(), 0.012, 0.001);
  EXPECT_GT(json["depth_delay_s"]["sigma"].get<double>(), 0);
  EXPECT_LT(json["depth_delay_s"]["sigma"].get<double>(), 0.002);
  EXPECT_EQ(json["readout_s"]["value"], 0);
  EXPECT_LT(json["stamp_sigma_s"].get<double>(), 1e-6) << "the simulator's stamps are whole microseconds";

  Calibration found;
  ASSERT_TRUE(read_calibration(yaml, found).ok());
  EXPECT_TRUE(found.camera.depth_timing.known);
  EXPECT_NEAR(found.camera.depth_timing.delay_s, json["depth_delay_s"]["value"].get<double>(), 1e-6);
  EXPECT_EQ(found.camera.pinhole.fx, 262.5);
  EXPECT_EQ(found.camera.width, 320);
  EXPECT_EQ(found.depth_units_per_metre, 5000);
  EXPECT_TRUE(found.readout_given);
  EXPECT_NE(test::read_file(folder / "page.html").find("<polyline"), std::string::npos);
  const CommandResult run = run_command(kPlvo + " run " + walk + " --quiet --calibration " + yaml);
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(run.err, "");
}

TEST(CliCalibrate, ARecordingThatIsTooShortIsRefusedInOneLine) {
  const TemporaryFolder folder;
  ASSERT_TRUE(test::write_tiny_sequence(folder / "walk", 5).ok());
  const std::string yaml = (folder / "camera.yaml").string();
  const CommandResult r = run_command(kPlvo + " calibrate " + (folder / "walk").string() + " --out " + yaml);
  EXPECT_EQ(r.exit_code, 1);
  EXPECT_EQ(r.out, "");
  EXPECT_EQ(r.err.rfind("plvo: error: only ", 0), 0u) << r.err;
  EXPECT_NE(r.err.find("record 10 s or more"), std::string::npos) << r.err;
  EXPECT_FALSE(std::filesystem::exists(yaml));
  const CommandResult missing =
      run_command(kPlvo + " calibrate " + (folder / "nothing").string() + " --out " + yaml);
  EXPECT_EQ(missing.exit_code, 1);
  EXPECT_NE(missing.err.find("nothing"), std::string::npos) << missing.err;
}

TEST(CliCalibrate, AnInputIsNotOverwritten) {
  const TemporaryFolder folder;
  ASSERT_TRUE(test::write_tiny_sequence(folder / "walk", 2).ok());
  const std::string walk = (folder / "walk").string();
  const CommandResult r = run_command(kPlvo + " calibrate " + walk + " --out " + walk + "/calibration.txt");
  EXPECT_EQ(r.exit_code, 2);
  EXPECT_NE(r.err.find("is an input, which would be overwritten"), std::string::npos) << r.err;
}

}  // namespace
}  // namespace plvo
