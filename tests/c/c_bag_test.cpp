// SPDX-License-Identifier: Apache-2.0
// ROS 1 bags through the C interface: the frames of the folder that the bag was made from, its camera_info,
// topics by name, and the library's error messages.
#include <cstring>

#include "bag_of_folder.hpp"
#include "command.hpp"
#include "moving_imu.hpp"
#include "plvo/c/sequence.h"
#include "procedural_sequence.hpp"
#include "temporary_folder.hpp"
#include "tiny_sequence.hpp"

namespace plvo {
namespace {

using test::TemporaryFolder;
using test::write_file;

// Closes the recording that it opened.
struct Opened {
  explicit Opened(const std::string& file, const char* calibration = nullptr)
      : status(plvo_sequence_open(file.c_str(), calibration, &sequence)) {}
  Opened(const std::string& file, const plvo_bag_topics& topics)
      : status(plvo_sequence_open_bag(file.c_str(), nullptr, &topics, &sequence)) {}
  Opened(const Opened&) = delete;
  Opened& operator=(const Opened&) = delete;
  ~Opened() { plvo_sequence_close(sequence); }
  bool says(const char* words) const { return std::strstr(status.message, words) != nullptr; }

  plvo_sequence* sequence = nullptr;
  plvo_status status;
};

class CBag : public ::testing::Test {
 protected:
  void SetUp() override { ASSERT_TRUE(test::write_tiny_sequence(folder_ / "tiny", kFrames).ok()); }
  // prefix: precedes each topic.
  std::string bag(const std::string& prefix = "", const std::string& leave_out = "none") {
    std::vector<test::RecordedMessage> messages = test::published(folder_ / "tiny", true);
    std::erase_if(messages, [&](const auto& message) { return message.topic == leave_out; });
    if (!prefix.empty()) {
      const std::vector<test::RecordedMessage> once = messages;
      messages.insert(messages.end(), once.begin(), once.end());
      for (std::size_t i = 0; i < once.size(); ++i)
        messages[i].topic = (once[i].topic == test::kNotRead ? "" : prefix) + once[i].topic;
    }
    write_file(folder_ / "tiny.bag", test::bag_of(messages, "bz2"));
    return (folder_ / "tiny.bag").string();
  }
  static void expect_the_folders_frames(plvo_sequence* sequence) {
    EXPECT_EQ(plvo_sequence_frame_count(sequence), std::size_t{kFrames});
    plvo_camera camera;
    plvo_camera_init(&camera, sizeof camera);
    ASSERT_EQ(plvo_sequence_camera(sequence, &camera).code, PLVO_OK);
    EXPECT_EQ(camera.width, test::kTinyWidth);
    EXPECT_EQ(camera.fx, 80);
    plvo_frame frame = {};
    frame.struct_size = sizeof frame;
    for (int i = 0; i < kFrames; ++i) {
      const plvo_status status = plvo_sequence_next(sequence, &frame);
      ASSERT_EQ(status.code, PLVO_OK) << status.message;
      const test::TinyFrame truth(i);
      EXPECT_EQ(frame.stamp_ns, test::tiny_stamp(i));
      EXPECT_EQ(frame.depth_stamp_ns, truth.frame.depth_stamp_ns);
      EXPECT_EQ(std::memcmp(frame.colour, truth.rgb.data(), truth.rgb.size()), 0);
      EXPECT_EQ(std::memcmp(frame.depth, truth.depth.data(), 2 * truth.depth.size()), 0);
      EXPECT_EQ(frame.metres_per_unit, 1.0 / 5000);
    }
    EXPECT_EQ(plvo_sequence_next(sequence, &frame).code, PLVO_END_OF_STREAM);
  }

  static constexpr int kFrames = 3;
  TemporaryFolder folder_;
};

TEST_F(CBag, EqualsTheFramesOfTheFolder) {
  const Opened opened(bag());
  ASSERT_EQ(opened.status.code, PLVO_OK) << opened.status.message;
  expect_the_folders_frames(opened.sequence);
}

TEST_F(CBag, ProgramOfThePageEqualsThePosesOfTheFolder) {
  ProceduralSequence rendered(320, 240);
  TumWriter writer;
  ASSERT_TRUE(writer.open(folder_ / "sequence", rendered.camera(), 1000).ok());
  for (int i = 0; i < 4; ++i) ASSERT_TRUE(writer.write(rendered.render(i)).ok());
  // Whole units of 16UC1 are millimetres.
  write_file(folder_ / "recording.bag", test::bag_of(test::published(folder_ / "sequence", false), "none"));
  const std::string program = PLVO_C_EXAMPLE;
  const test::CommandResult of_folder = test::run_command(program + ' ' + (folder_ / "sequence").string());
  const test::CommandResult of_bag = test::run_command(program + ' ' + (folder_ / "recording.bag").string());
  EXPECT_EQ(of_bag.exit_code, 0) << of_bag.err;
  EXPECT_EQ(of_bag.out, of_folder.out);
  EXPECT_EQ(std::count(of_bag.out.begin(), of_bag.out.end(), '\n'), 4) << of_bag.out;
}

TEST_F(CBag, ChoosesTopicsByName) {
  const std::string file = bag("/front");
  const std::string colour = "/front" + std::string(test::kTumColour);
  const std::string depth = "/front" + std::string(test::kTumDepth);
  plvo_bag_topics topics = {};
  topics.struct_size = sizeof topics;
  topics.colour = colour.c_str();
  topics.depth = depth.c_str();
  const Opened opened(file, topics);
  ASSERT_EQ(opened.status.code, PLVO_OK) << opened.status.message;
  expect_the_folders_frames(opened.sequence);
  topics.camera_info = "/side/camera_info";
  EXPECT_TRUE(
      Opened(file, topics).says("there is no camera_info on /side/camera_info; topics of that type: /front"));
  topics.struct_size = 8;
  EXPECT_TRUE(Opened(file, topics).says("bag_topics.struct_size is 8; set it to sizeof(plvo_bag_topics)"));
}

// The readings of the folder, and the poses of a program that uses them.
TEST_F(CBag, ReadsGyroAndAccelerometer) {
  ProceduralSequence rendered(320, 240);
  TumWriter writer;
  ASSERT_TRUE(writer.open(folder_ / "sequence", rendered.camera(), 1000).ok());
  ImuRecording recorded;
  for (int i = 0; i < 4; ++i) {
    ASSERT_TRUE(writer.write(rendered.render(i)).ok());
    for (const ImuReading& reading : imu_readings(i)) {
      recorded.gyro.push_back({reading.stamp_ns, reading.rate});
      recorded.accelerometer.push_back({reading.stamp_ns, reading.force});
    }
  }
  ASSERT_TRUE(write_imu_files(folder_ / "sequence", recorded, ImuAxes::kSensor).ok());
  std::vector<test::RecordedMessage> messages =
      test::published_imu(folder_ / "sequence", "/imu", test::ImuContent::kBoth);
  const std::vector<test::RecordedMessage> images = test::published(folder_ / "sequence", false);
  messages.insert(messages.end(), images.begin(), images.end());
  write_file(folder_ / "recording.bag", test::bag_of(messages, "lz4"));

  const std::string program = PLVO_C_IMU_EXAMPLE;
  const test::CommandResult of_folder = test::run_command(program + ' ' + (folder_ / "sequence").string());
  const test::CommandResult of_bag = test::run_command(program + ' ' + (folder_ / "recording.bag").string());
  EXPECT_EQ(of_bag.exit_code, 0) << of_bag.err;
  EXPECT_EQ(of_bag.out, of_folder.out);
  EXPECT_EQ(std::count(of_bag.out.begin(), of_bag.out.end(), '\n'), 4) << of_bag.out;

  plvo_bag_topics topics = {};
  topics.struct_size = offsetof(plvo_bag_topics, gyro);  // a program that knows neither of the two fields
  topics.gyro = "/side/imu";
  const Opened older((folder_ / "recording.bag").string(), topics);
  plvo_imu_readings readings = {};
  readings.struct_size = sizeof readings;
  EXPECT_EQ(plvo_sequence_imu(older.sequence, &readings).code, PLVO_OK);
  ASSERT_EQ(readings.gyro_count, recorded.gyro.size());
  EXPECT_EQ(readings.gyro[1].value[0], recorded.gyro[1].value.x());
  topics.struct_size = sizeof topics;
  const Opened named((folder_ / "recording.bag").string(), topics);
  ASSERT_EQ(named.status.code, PLVO_OK) << named.status.message;
  const plvo_status status = plvo_sequence_imu(named.sequence, &readings);
  EXPECT_EQ(status.code, PLVO_NOT_FOUND);
  EXPECT_NE(std::strstr(status.message, "on /side/imu; they are on /imu"), nullptr) << status.message;
  EXPECT_EQ(readings.accelerometer_count, 0U);
}

TEST_F(CBag, ReportsErrors) {
  const Opened nowhere((folder_ / "nowhere.bag").string());
  EXPECT_EQ(nowhere.status.code, PLVO_NOT_FOUND);
  EXPECT_EQ(nowhere.sequence, nullptr);
  const Opened bare(bag("", test::kTumInfo));
  EXPECT_EQ(bare.status.code, PLVO_NOT_FOUND);
  EXPECT_TRUE(bare.says("the bag has no camera_info: give a calibration")) << bare.status.message;
  write_file(folder_ / "calibration", "80 80 47.5 31.5");
  const Opened told(bag("", test::kTumInfo), (folder_ / "calibration").c_str());
  ASSERT_EQ(told.status.code, PLVO_OK) << told.status.message;
  expect_the_folders_frames(told.sequence);
  const Opened folder((folder_ / "tiny").string(),
                      plvo_bag_topics{sizeof(plvo_bag_topics), {}, {}, {}, {}, {}});
  EXPECT_TRUE(folder.says("the name of a ROS 1 bag ends in .bag")) << folder.status.message;
}

}  // namespace
}  // namespace plvo
