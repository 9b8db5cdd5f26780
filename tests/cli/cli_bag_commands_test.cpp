// SPDX-License-Identifier: Apache-2.0
// A ROS 1 bag in the other commands gives the same as the folder that it was made from: the true poses beside
// it in `plvo run` and `plvo eval`, a folder written by `plvo record`, and the results of `plvo live` and
// `plvo calibrate`.
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

#include "bag_of_folder.hpp"
#include "plvo_command.hpp"
#include "recorded_sequence.hpp"
#include "turning_hand.hpp"

namespace plvo {
namespace {

namespace fs = std::filesystem;
using test::CommandResult;
using test::ImuContent;
using test::read_file;
using test::recorded_sequence;
using test::RecordedMessage;
using test::write_file;

class CliBagCommands : public test::PlvoCommand {
 protected:
  void SetUp() override {
    std::vector<RecordedMessage> messages =
        test::published_imu(recorded_sequence(), "/imu", ImuContent::kBoth);
    const std::vector<RecordedMessage> images = test::published(recorded_sequence(), true);
    messages.insert(messages.end(), images.begin(), images.end());
    write_file(folder_ / "recording.bag", test::bag_of(messages, "none"));
  }
  static void expect_refused(const std::string& arguments, int exit_code, const std::string& words) {
    PlvoCommand::expect_refused(plvo(arguments), exit_code, words);
  }
  // Trajectory and covariances of `plvo run`.
  std::string bytes_of(const std::string& recording, const std::string& options = "") const {
    const CommandResult r = plvo("run " + recording + " --readout 0 --quiet --out " + path("t") +
                                 " --covariance " + path("c") + ' ' + options);
    EXPECT_EQ(r.exit_code, 0) << r.err;
    return read_file(folder_ / "t") + read_file(folder_ / "c");
  }
};

TEST_F(CliBagCommands, EscapesControlCharactersInTopicNames) {
  // Two topics of each kind, none with a known name: the message lists them.
  std::vector<RecordedMessage> messages;
  for (const char* camera : {"/1", "/2"})
    for (RecordedMessage message : test::published(recorded_sequence(), true)) {
      // A message on kNotRead ends a chunk.
      if (message.topic != test::kNotRead) message.topic = "/\x1b[31m\u009b\nx" + (camera + message.topic);
      messages.push_back(message);
    }
  write_file(folder_ / "two.bag", test::bag_of(messages, "none"));
  for (const std::string& words :
       {"run " + path("two.bag"), "run " + path("recording.bag") + " --depth-topic '/\x1b[31m'"}) {
    const CommandResult r = plvo(words);
    EXPECT_NE(r.exit_code, 0);
    EXPECT_NE(r.err.find("\\x1b[31m"), std::string::npos) << r.err;
    EXPECT_EQ(r.err.find('\x1b'), std::string::npos) << r.err;
    // A newline in a name starts no line of the program's.
    std::istringstream lines(r.err);
    for (std::string line; std::getline(lines, line);) EXPECT_TRUE(line.starts_with("plvo: ")) << r.err;
  }
}

TEST_F(CliBagCommands, FindsGroundTruthBesideTheBag) {
  const std::string bag = path("recording.bag"), run = " --readout 0 --quiet --out " + path("t") + " --json ";
  ASSERT_EQ(plvo("run " + bag + run + path("without")).exit_code, 0);
  EXPECT_FALSE(nlohmann::json::parse(read_file(folder_ / "without")).contains("evaluation"));
  expect_refused("eval --gt " + bag + " --est " + path("t"), 1,
                 "recording.bag has no poses: put the true ones beside it, as recording-groundtruth.txt, or "
                 "name a trajectory");
  fs::copy_file(recorded_sequence() / "groundtruth.txt", folder_ / "recording-groundtruth.txt");
  ASSERT_EQ(plvo("run " + bag + run + path("with")).exit_code, 0);
  ASSERT_EQ(plvo("run " + recorded_sequence().string() + run + path("folder")).exit_code, 0);
  const auto evaluation = [&](const char* name) {
    return nlohmann::json::parse(read_file(folder_ / name)).at("evaluation");
  };
  EXPECT_EQ(evaluation("with"), evaluation("folder"));
  EXPECT_LT(evaluation("with")["ate_m"]["rmse"].get<double>(), 0.02);
  const CommandResult of_bag = plvo("eval --json - --gt " + bag + " --est " + path("t"));
  const CommandResult of_folder =
      plvo("eval --json - --gt " + recorded_sequence().string() + " --est " + path("t"));
  EXPECT_EQ(of_bag.exit_code, 0) << of_bag.err;
  EXPECT_EQ(of_bag.out, of_folder.out);
  expect_refused("eval --gt " + bag + " --gt-format tum --est " + path("t"), 2,
                 "--gt-format: is for a trajectory");
  expect_refused("eval --est " + bag + " --gt " + path("recording-groundtruth.txt"), 2,
                 "--est: a ROS bag is a recording; name the trajectory");
  expect_refused("run " + bag + " --out " + path("recording-groundtruth.txt"), 2, "is an input");
  expect_refused("eval --gt " + bag + " --est " + path("t") + " --json " + path("recording-groundtruth.txt"),
                 2, "is an input");
}

TEST_F(CliBagCommands, RecordWritesAFolder) {
  const CommandResult r =
      plvo("record " + path("made") + " --imu --readout 0 --device " + path("recording.bag"));
  ASSERT_EQ(r.exit_code, 0) << r.err;
  EXPECT_NE(r.out.find("6 frames in "), std::string::npos) << r.out;
  const std::string bag = path("recording.bag"), made = path("made");
  EXPECT_EQ(bytes_of(made), bytes_of(bag));
  EXPECT_EQ(bytes_of(made, "--imu"), bytes_of(bag, "--imu"));
  EXPECT_NE(bytes_of(made, "--imu"), bytes_of(made)) << "the readings matter";
  EXPECT_EQ(read_file(folder_ / "made/rgb.txt").substr(0, 200),
            read_file(recorded_sequence() / "rgb.txt").substr(0, 200));
  ASSERT_EQ(plvo("record " + path("short") + " --frames 2 --device " + bag).exit_code, 0);
  EXPECT_EQ(bytes_of(path("short")), bytes_of(bag, "--frames 2"));
  EXPECT_FALSE(fs::exists(folder_ / "short/accelerometer.txt")) << "nobody asked";
}

TEST_F(CliBagCommands, RecordWritesOneFileForAnAccelerometerAlone) {
  std::vector<RecordedMessage> messages =
      test::published_imu(recorded_sequence(), "/imu", ImuContent::kAcceleration);
  const std::vector<RecordedMessage> images = test::published(recorded_sequence(), true);
  messages.insert(messages.end(), images.begin(), images.end());
  write_file(folder_ / "recording.bag", test::bag_of(messages, "none"));
  ASSERT_EQ(plvo("record " + path("made") + " --imu --device " + path("recording.bag")).exit_code, 0);
  EXPECT_FALSE(fs::exists(folder_ / "made/gyroscope.txt"));
  EXPECT_EQ(bytes_of(path("made"), "--imu"), bytes_of(path("recording.bag"), "--imu"));
}

TEST_F(CliBagCommands, LivePlaysEveryFrame) {
  const CommandResult r = plvo("live --readout 0 --quiet --device " + path("recording.bag") + " --record " +
                               path("kept") + " --out " + path("t") + " --covariance " + path("c"));
  ASSERT_EQ(r.exit_code, 0) << r.err;
  const std::string bytes = read_file(folder_ / "t") + read_file(folder_ / "c");
  EXPECT_EQ(bytes, bytes_of(recorded_sequence().string()));
  EXPECT_EQ(bytes, bytes_of(path("kept")));
}

TEST_F(CliBagCommands, LiveEndsInAGapOfTheRecording) {
  std::vector<RecordedMessage> messages = test::published(recorded_sequence(), true);
  // The second byte of the stamp's seconds, behind the four bytes of the sequence number: 256 s later.
  for (std::size_t i = messages.size() / 2; i < messages.size(); ++i) ++messages[i].data[5];
  write_file(folder_ / "gap.bag", test::bag_of(messages, "none"));
  const CommandResult r =
      plvo("live --quiet --seconds 1 --json " + path("own.json") + " --device " + path("gap.bag"));
  ASSERT_EQ(r.exit_code, 0) << r.err;
  EXPECT_LT(nlohmann::json::parse(read_file(path("own.json")))["seconds"].get<double>(), 200);
}

TEST_F(CliBagCommands, RejectsOptionsThatDoNotApply) {
  const std::string device = " --device " + path("recording.bag");
  expect_refused("record " + path("x.oni") + device, 2, "a ROS bag is kept as a folder, not as an .oni file");
  expect_refused("live --record " + path("x.oni") + device, 2,
                 "a ROS bag and the simulated camera are kept as a folder");
  expect_refused("live --mode 320x240" + device, 2, "--mode: does not apply to a recording");
  expect_refused("live --every-frame" + device, 2,
                 "--every-frame: is what a recording and the simulated camera do anyway");
  expect_refused("live --imu" + device, 2, "--imu: is for a live Kinect");
  expect_refused("live --colour-topic /x", 2, "--colour-topic: is for a ROS bag");
  expect_refused("record " + path("x") + " --gyro-topic /imu" + device, 2, "--gyro-topic: is for --imu");
  expect_refused("record " + path("x.oni") + " --imu", 2, "--imu: an .oni file keeps no readings of it");
  expect_refused("record " + path("x") + " --imu --device recording.oni", 2,
                 "--imu: does not apply to an .oni file");
  expect_refused("doctor" + device, 2, "--device: a ROS bag is not a sensor");
  expect_refused("calibrate " + recorded_sequence().string() + " --depth-topic /x --out " + path("y"), 2,
                 "--depth-topic: is for a ROS bag");
  expect_refused("calibrate " + path("recording.bag") + " --depth-topic /x --out " + path("y"), 1,
                 "there are no images on /x; images are on: ");
  expect_refused("calibrate " + path("recording.bag") + " --out " + path("recording.bag"), 2, "is an input");
  expect_refused("record " + path("x") + " --imu --gyro-topic /x" + device, 1,
                 "there are no readings of a gyro (sensor_msgs/Imu) on /x; they are on /imu");
  expect_refused("record " + path("x") + " --device " + path("none.bag"), 1, "none.bag");
  EXPECT_FALSE(fs::exists(folder_ / "x")) << "nothing was made of what was refused";
  fs::create_directory(folder_ / "mine");
  write_file(folder_ / "mine/accelerometer.txt", "mine");
  expect_refused("record " + path("mine") + " --imu" + device, 1, "has accelerometer.txt already");
  EXPECT_EQ(read_file(folder_ / "mine/accelerometer.txt"), "mine");
}

// The numbers are the same; only the first line names the recording.
TEST_F(CliBagCommands, CalibrateEqualsTheFolder) {
  write_file(folder_ / "hand.txt", test::turning_hand(2.2));
  const CommandResult made =
      plvo("simulate --quiet --frames 60 --size 320x240 --scene desk --depth-delay 0.012 --out " +
           path("turns") + " --trajectory " + path("hand.txt"));
  ASSERT_EQ(made.exit_code, 0) << made.err;
  write_file(folder_ / "turns.bag", test::bag_of(test::published(folder_ / "turns", true), "none"));
  const auto calibrated = [&](const std::string& name, const std::string& more) {
    const CommandResult r =
        plvo("calibrate " + path(name) + " --find delay --quiet --readout 0 --out " + path("y") + more);
    EXPECT_EQ(r.exit_code, 0) << r.err;
    const std::string yaml = read_file(folder_ / "y");
    return yaml.substr(yaml.find('\n'));
  };
  const std::string lens = " --fx 262.5 --fy 262.5 --cx 159.5 --cy 119.5";
  const std::string of_bag = calibrated("turns.bag", lens);
  EXPECT_EQ(of_bag, calibrated("turns", lens + " --depth-scale 5000"));
  EXPECT_NE(of_bag.find("depth_delay_s: 0.01"), std::string::npos) << of_bag;
}

}  // namespace
}  // namespace plvo
