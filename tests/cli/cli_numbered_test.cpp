// SPDX-License-Identifier: Apache-2.0
// Tests folders of numbered frames with `plvo run` and `plvo eval`.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "numbered_sequence.hpp"
#include "plvo_command.hpp"

namespace plvo {
namespace {

namespace fs = std::filesystem;
using test::CommandResult;
using test::read_file;
using test::write_file;

class CliNumbered : public test::PlvoCommand {
 protected:
  void expect_refused(const std::string& arguments, int exit_code, const std::string& words) const {
    SCOPED_TRACE(arguments);
    PlvoCommand::expect_refused(plvo(arguments), exit_code, words);
  }

  test::NumberedSequence sequence_;
  const std::string tum_ = sequence_.tum().string();
  const std::string seven_ = sequence_.seven_scenes().string();
  const std::string scannet_ = sequence_.scannet().string();
};

TEST_F(CliNumbered, RunsAsTheTumFolderWithTheSameStamps) {
  ASSERT_TRUE(sequence_.good());
  for (const auto& [folder, name] :
       {std::pair(tum_, "tum"), std::pair(seven_, "seven"), std::pair(scannet_, "scannet")}) {
    const std::string out = path(name);
    const CommandResult r = plvo("run " + folder + " --quiet --readout 0 --out " + out +
                                 ".txt --covariance " + out + ".cov --json " + out + ".json");
    ASSERT_EQ(r.exit_code, 0) << r.err;
    EXPECT_EQ(r.err, "");
    EXPECT_EQ(read_file(out + ".txt"), read_file(path("tum.txt"))) << name;
    EXPECT_EQ(read_file(out + ".cov"), read_file(path("tum.cov"))) << name;
    const auto json = nlohmann::json::parse(read_file(out + ".json"));
    EXPECT_EQ(json["frames"], test::kNumberedFrames);
    EXPECT_LT(json["evaluation"]["ate_m"]["rmse"], 0.02) << name;
  }
  // plvo eval also reads the pose files.
  for (const std::string& truth : {tum_ + "/groundtruth.txt", tum_, seven_, scannet_}) {
    const CommandResult r = plvo("eval --gt " + truth + " --est " + path("seven.txt") + " --json -");
    ASSERT_EQ(r.exit_code, 0) << r.err;
    const auto json = nlohmann::json::parse(r.out);
    EXPECT_NEAR(
        json["ate_m"]["rmse"].get<double>(),
        nlohmann::json::parse(read_file(path("tum.json")))["evaluation"]["ate_m"]["rmse"].get<double>(), 1e-7)
        << truth;
  }
}

TEST_F(CliNumbered, StampsFollowFromTheRate) {
  ASSERT_EQ(plvo("run " + seven_ + " --rate 10 --quiet --out " + path("t.txt")).exit_code, 0);
  EXPECT_NE(read_file(path("t.txt")).find("\n0.500000 "), std::string::npos);
  EXPECT_EQ(plvo("eval --gt " + seven_ + " --rate 10 --est " + path("t.txt")).exit_code, 0);
  expect_refused("run " + tum_ + " --rate 10", 2, "--rate: is for numbered frames; this sequence has stamps");
  expect_refused("run --camera sim --rate 10", 2, "--rate: is for recorded sequences");
  expect_refused("run " + seven_ + " --rate 0", 2, "--rate: expected a number from 0.1 to 1000");
  expect_refused("run " + seven_ + " --tolerance 0.1", 2, "--tolerance: does not apply to numbered frames");
  expect_refused("eval --gt " + tum_ + "/groundtruth.txt --rate 10 --est " + path("t.txt"), 2,
                 "--rate: is for a folder of numbered frames");
  expect_refused("eval --gt " + seven_ + " --gt-format tum --est " + path("t.txt"), 2,
                 "--gt-format: is for a trajectory");
}

TEST_F(CliNumbered, InvalidPosesAreCounted) {
  ASSERT_EQ(plvo("run " + scannet_ + " --quiet --out " + path("t.txt")).exit_code, 0);
  const std::string row = "-inf -inf -inf -inf\n";
  write_file(sequence_.scannet() / "pose/2.txt", row + row + row + row);
  const CommandResult r = plvo("eval --gt " + scannet_ + " --est " + path("t.txt"));
  EXPECT_EQ(r.exit_code, 0);
  EXPECT_NE(r.err.find("1 poses with a NaN, an infinity or a repeated stamp were ignored"), std::string::npos)
      << r.err;
}

TEST_F(CliNumbered, AsksForACalibrationAndWarnsOfGaps) {
  fs::remove_all(sequence_.scannet() / "intrinsic");
  expect_refused("run " + scannet_, 1, "no calibration: give --calibration FILE, --camera-model NAME (");
  expect_refused("run " + scannet_ + " --camera-model 7scenes", 1,
                 "the calibration is for 640x480 images, these are 320x240");
  fs::remove(sequence_.seven_scenes() / "frame-000002.depth.png");
  const CommandResult r = plvo("run " + seven_);
  EXPECT_EQ(r.exit_code, 0) << r.err;
  EXPECT_NE(r.err.find("between the frames 0 and 5: 1, the first is 2;"), std::string::npos) << r.err;
  EXPECT_NE(r.out.find("colour without depth"), std::string::npos) << r.out;
}

TEST_F(CliNumbered, OutputsDoNotOverwriteInputs) {
  for (const char* name : {"pose/1.txt", "color/0.png", "intrinsic/intrinsic_depth.txt"})
    expect_refused("run " + scannet_ + " --out " + scannet_ + '/' + name, 2, "is an input");
  write_file(path("t.txt"), "0 0 0 0 0 0 0 1\n");
  expect_refused("eval --gt " + scannet_ + " --est " + path("t.txt") + " --json " + scannet_ + "/pose/1.txt",
                 2, "is an input");
}

}  // namespace
}  // namespace plvo
