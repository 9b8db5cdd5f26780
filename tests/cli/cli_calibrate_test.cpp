// SPDX-License-Identifier: Apache-2.0
// Tests `plvo calibrate` through the command line.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "plvo/replay/calibration/calibration.hpp"
#include "plvo_command.hpp"
#include "tiny_sequence.hpp"
#include "turning_hand.hpp"

namespace plvo {
namespace {

using test::CommandResult;
using test::kPlvo;
using test::run_command;
using test::run_plvo;
using test::TemporaryFolder;

void record_turns(const TemporaryFolder& folder, const std::string& name, int seed, int frames) {
  const std::string hand = (folder / ("hand_" + name)).string();
  test::write_file(hand, test::turning_hand(0.2 + frames / 30.0));
  const CommandResult made =
      run_plvo("simulate --quiet --size 320x240 --depth-delay 0.012 --frames " + std::to_string(frames) +
               " --scene desk --seed " + std::to_string(seed) + " --out " + (folder / name).string() +
               " --trajectory " + hand);
  ASSERT_EQ(made.exit_code, 0) << made.err;
}

constexpr const char* kLens = " --fx 262.5 --fy 262.5 --cx 159.5 --cy 119.5 --depth-scale 5000 --readout 0";

TEST(CliCalibrate, RecoversTheDelayOfDepthFromTheRecordingAlone) {
  const TemporaryFolder folder;
  const std::string recording = (folder / "sequence").string(), yaml = (folder / "camera.yaml").string();
  record_turns(folder, "sequence", 1, 60);
  // The lens is given, but no timing of depth.
  const CommandResult r = run_plvo("calibrate " + recording + " --find delay --quiet --json - --report " +
                                   (folder / "page.html").string() + " --out " + yaml + kLens);
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
  const CommandResult run = run_plvo("run " + recording + " --quiet --calibration " + yaml);
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(run.err, "");
}

TEST(CliCalibrate, SeveralRecordingsGiveOneAnswer) {
  const TemporaryFolder folder;
  record_turns(folder, "long", 1, 40);
  record_turns(folder, "short", 2, 20);
  const std::string first = (folder / "long").string(), second = (folder / "short").string();
  const std::string rest = " --find delay --out " + (folder / "camera.yaml").string() + kLens;
  // Each recording alone is too short.
  const CommandResult alone = run_plvo("calibrate --quiet " + first + rest);
  EXPECT_EQ(alone.exit_code, 1);
  EXPECT_NE(alone.err.find("of 40 frames could be tracked"), std::string::npos) << alone.err;
  const CommandResult r = run_plvo("calibrate " + first + rest + " --json - " + second + " --frames 60");
  ASSERT_EQ(r.exit_code, 0) << r.err;
  const auto json = nlohmann::json::parse(r.out);
  EXPECT_EQ(json["frames"], 60);
  EXPECT_NEAR(json["depth_delay_s"]["value"].get<double>(), 0.012, 0.001);
  EXPECT_EQ(test::read_file(folder / "camera.yaml").rfind("# Made by plvo calibrate from long short\n", 0),
            0u);
  // The progress is also reported without a terminal: tracked frames and results, pass by pass.
  EXPECT_EQ(r.err.rfind("plvo: tracking at most 60 frames of long short, a few times over\n", 0), 0u)
      << r.err;
  std::size_t passes = 0;
  for (const auto& pass : json["passes"]) {
    const std::string begin = fmt::format("plvo: pass {}: ", ++passes);
    EXPECT_NE(r.err.find(begin + "60 frames tracked, "), std::string::npos) << r.err;
    EXPECT_NE(r.err.find(fmt::format("{}delay {:+.1f} ms", begin, 1e3 * pass[0].get<double>())),
              std::string::npos)
        << r.err;
  }
  EXPECT_GE(passes, 2u);
}

TEST(CliCalibrate, ShowsProgressOnATerminal) {
  const TemporaryFolder folder;
  ASSERT_TRUE(test::write_tiny_sequence(folder / "sequence", 5).ok());
  const CommandResult r = run_command("script -qefc '" + kPlvo + " calibrate " +
                                      (folder / "sequence").string() + " --out /dev/null' /dev/null");
  EXPECT_EQ(r.exit_code, 1) << r.out;
  EXPECT_NE(r.out.find("sequence: tracking frame 1 of at most 5"), std::string::npos) << r.out;
}

TEST(CliCalibrate, RecordingsOfTwoSensorsAreRefused) {
  const TemporaryFolder folder;
  ASSERT_TRUE(test::write_tiny_sequence(folder / "one", 2).ok());
  ASSERT_TRUE(test::write_tiny_sequence(folder / "two", 2).ok());
  test::write_file(folder / "two/calibration.txt", "81 80 47.5 31.5 5000\n");
  const std::string both = (folder / "one").string() + ' ' + (folder / "two").string();
  const CommandResult r = run_plvo("calibrate " + both + " --out " + (folder / "c").string());
  EXPECT_EQ(r.exit_code, 1);
  EXPECT_NE(r.err.find("has another lens than"), std::string::npos) << r.err;
  const CommandResult given =
      run_plvo("calibrate " + both + " --fx 80 --fy 80 --cx 47.5 --cy 31.5 --out " + (folder / "c").string());
  EXPECT_NE(given.err.find("of 4 frames could be tracked"), std::string::npos) << given.err;
}

TEST(CliCalibrate, ARecordingThatIsTooShortIsRefusedInOneLine) {
  const TemporaryFolder folder;
  ASSERT_TRUE(test::write_tiny_sequence(folder / "sequence", 5).ok());
  const std::string yaml = (folder / "camera.yaml").string();
  const CommandResult r = run_plvo("calibrate --quiet " + (folder / "sequence").string() + " --out " + yaml);
  EXPECT_EQ(r.exit_code, 1);
  EXPECT_EQ(r.out, "");
  EXPECT_EQ(r.err.rfind("plvo: error: only ", 0), 0u) << r.err;
  EXPECT_NE(r.err.find("record 10 s or more"), std::string::npos) << r.err;
  EXPECT_FALSE(std::filesystem::exists(yaml));
  const CommandResult missing = run_plvo("calibrate " + (folder / "nothing").string() + " --out " + yaml);
  EXPECT_EQ(missing.exit_code, 1);
  EXPECT_NE(missing.err.find("nothing"), std::string::npos) << missing.err;
}

TEST(CliCalibrate, AnInputIsNotOverwritten) {
  const TemporaryFolder folder;
  ASSERT_TRUE(test::write_tiny_sequence(folder / "sequence", 2).ok());
  const std::string recording = (folder / "sequence").string();
  const CommandResult r = run_plvo("calibrate " + recording + " --out " + recording + "/calibration.txt");
  EXPECT_EQ(r.exit_code, 2);
  EXPECT_NE(r.err.find("is an input, which would be overwritten"), std::string::npos) << r.err;
}

}  // namespace
}  // namespace plvo
