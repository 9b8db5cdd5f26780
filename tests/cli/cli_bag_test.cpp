// SPDX-License-Identifier: Apache-2.0
// `plvo run` of a ROS 1 bag gives the bytes of the folder that it was made from, whichever library wrote the
// bag. Faults of the bag give a message.
#include <gtest/gtest.h>

#include <fmt/core.h>

#include <nlohmann/json.hpp>

#include "bag_of_folder.hpp"
#include "plvo_command.hpp"
#include "recorded_sequence.hpp"

namespace plvo {
namespace {

namespace fs = std::filesystem;
using test::CommandResult;
using test::kPlvo;
using test::read_file;
using test::recorded_sequence;
using test::RecordedMessage;
using test::run_command;
using test::write_file;

std::vector<RecordedMessage> published(bool metres) { return test::published(recorded_sequence(), metres); }

class CliBag : public test::PlvoCommand {
 protected:
  CommandResult run(const std::string& more) const {
    return plvo("run " + path("recording.bag") + ' ' + more);
  }
  void write(const std::vector<RecordedMessage>& messages, const std::string& compression = "none") const {
    write_file(folder_ / "recording.bag", test::bag_of(messages, compression));
  }
  void run_folder() const {
    const CommandResult r = plvo("run " + recorded_sequence().string() + " --quiet --out " + path("folder") +
                                 " --covariance " + path("folder_c"));
    ASSERT_EQ(r.exit_code, 0) << r.err;
  }
  void expect_the_folders_bytes(const std::string& options) const {
    const CommandResult r =
        run("--readout 0 --quiet --out " + path("bag") + " --covariance " + path("bag_c") + ' ' + options);
    ASSERT_EQ(r.exit_code, 0) << r.err;
    EXPECT_EQ(r.err, "");
    EXPECT_EQ(read_file(folder_ / "bag"), read_file(folder_ / "folder"));
    EXPECT_EQ(read_file(folder_ / "bag_c"), read_file(folder_ / "folder_c"));
  }
  void expect_refused(const std::string& options, int exit_code, const std::string& words) const {
    PlvoCommand::expect_refused(run(options), exit_code, words);
  }
};

TEST_F(CliBag, EqualsTheBytesOfTheFolder) {
  run_folder();
  for (const char* compression : {"none", "bz2", "lz4"}) {
    write(published(true), compression);
    expect_the_folders_bytes("");
  }
  write(published(false));
  expect_the_folders_bytes("--depth-scale 5000");  // whole units; ROS defines a thousand per metre
}

// Sorting by stamp would interleave the images before and after the step.
TEST_F(CliBag, RejectsAClockStep) {
  const std::vector<RecordedMessage> recorded = published(true);
  std::vector<RecordedMessage> messages;
  for (const std::ptrdiff_t frame : {0, 2, 4, 1, 3, 5})
    messages.insert(messages.end(), recorded.begin() + 4 * frame, recorded.begin() + 4 * (frame + 1));
  write(messages);
  expect_refused("", 1, ": the clock steps back by ");
}

TEST_F(CliBag, ReadsBagsOfRosLibrary) {
#ifdef PLVO_HAVE_LIBROSBAG
  run_folder();
  std::string error;
  for (const char* compression : {"none", "bz2", "lz4"}) {
    ASSERT_TRUE(test::write_bag_with_library(path("recording.bag"), compression, published(true), error))
        << error;
    expect_the_folders_bytes("");
  }
#else
  GTEST_SKIP() << "SKIPPED: built without librosbag-storage-dev";
#endif
}

TEST_F(CliBag, RunsToTheEndOfATruncatedBag) {
  run_folder();
  const std::string whole = test::bag_of(published(true), "none");
  write_file(folder_ / "recording.bag", whole.substr(0, whole.size() * 7 / 10));
  const CommandResult r = run("--readout 0 --json " + path("j") + " --out " + path("t"));
  ASSERT_EQ(r.exit_code, 0) << r.err;
  EXPECT_NE(r.err.find("warning: recording.bag is cut short; what lies before byte "), std::string::npos)
      << r.err;
  EXPECT_EQ(nlohmann::json::parse(read_file(folder_ / "j"))["frames"], 4);
  EXPECT_TRUE(read_file(folder_ / "folder").starts_with(read_file(folder_ / "t")))
      << "the same poses until there";
}

TEST_F(CliBag, ChoosesTopicsByNameAndKind) {
  run_folder();
  std::vector<RecordedMessage> messages = published(true);
  for (RecordedMessage& message : messages)
    if (message.topic != test::kNotRead)
      message.topic = message.topic == test::kTumColour
                          ? "/front/image"
                          : (message.topic == test::kTumDepth ? "/front/z" : "/front/camera_info");
  write(messages);
  expect_the_folders_bytes("");  // the only topics of their kind
  // With a second camera, the user must choose.
  const std::size_t count = messages.size();
  for (std::size_t i = 0; i < count; ++i)
    if (messages[i].topic == "/front/image") {
      messages.insert(messages.begin(), messages[i]);
      messages.front().topic = "/back/image";
      break;
    }
  write(messages);
  expect_refused(
      "", 1,
      "several topics could be colour: choose with --colour-topic or topics.colour among /back/image (rgb8), "
      "/front/image (rgb8)");
  expect_the_folders_bytes(
      "--colour-topic /front/image --depth-topic /front/z --info-topic /front/camera_info");
  expect_refused("--colour-topic /side/image", 1,
                 "there are no images on /side/image; images are on: /back/image (rgb8), /front/z (32FC1)");
  expect_refused("--colour-topic /front/image --info-topic /x", 1,
                 "there is no camera_info on /x; topics of that type: /front/camera_info");
  // A colour topic without a camera_info beside it, and no calibration from the user.
  expect_refused(
      "--colour-topic /back/image", 1,
      "the bag has no /back/camera_info beside colour: give a calibration, or choose with --info-topic "
      "or topics.camera_info: /front/camera_info");
}

TEST_F(CliBag, ListsAllMatchingTopics) {
  std::vector<RecordedMessage> messages = published(true);
  std::string all;
  for (int i = 10; i < 30; ++i) {
    const std::string topic = fmt::format("/a_camera_with_a_long_name_{}/image", i);
    messages.push_back({topic, "sensor_msgs/Image", test::image_message(1, 1, 1, "bgr8", 3, "abc"), 1});
    all += topic + (i < 29 ? " (bgr8), " : " (bgr8)");
  }
  for (RecordedMessage& message : messages)
    if (message.topic == test::kTumColour) message.topic = "/front/image";
  messages.push_back({test::kNotRead, "tf2_msgs/TFMessage", "the end of the chunk", 1});
  write(messages);
  expect_refused("", 1, "several topics could be colour: choose with --colour-topic or topics.colour among ");
  expect_refused("", 1, "the topics are /front/image (rgb8), " + all);
}

// As librealsense writes it. Infrared images are grey, too; they count as depth only if nothing else does.
TEST_F(CliBag, AcceptsMono16AsDepth) {
  run_folder();
  std::vector<RecordedMessage> messages = published(false);
  for (RecordedMessage& message : messages)
    if (message.topic == test::kTumDepth) {
      message.topic = "/depth/image";
      const std::size_t encoding = message.data.find(test::wire_text("16UC1"));
      message.data.replace(encoding, 9, test::wire_text("mono16"));
    }
  write(messages);
  expect_the_folders_bytes("--depth-scale 5000");
  messages = published(false);
  for (RecordedMessage& message : messages)
    if (message.topic == test::kTumDepth) message.topic = "/depth/image";
  for (std::size_t i = 0, count = messages.size(); i < count; ++i)
    if (messages[i].topic == "/depth/image") {
      messages.insert(messages.begin(), messages[i]);
      messages.front().topic = "/infrared/image";
      messages.front().data.replace(messages.front().data.find(test::wire_text("16UC1")), 9,
                                    test::wire_text("mono16"));
      break;
    }
  write(messages);
  expect_the_folders_bytes("--depth-scale 5000");
}

// The largest 16-bit value is no depth, as in a folder.
TEST_F(CliBag, TreatsSaturatedDepthAsMissing) {
  run_folder();
  std::vector<RecordedMessage> messages = published(false);
  std::size_t holes = 0;
  for (RecordedMessage& message : messages)
    if (message.topic == test::kTumDepth)
      for (std::size_t i = message.data.size() - std::size_t{160} * 120 * 2; i < message.data.size(); i += 2)
        if (message.data[i] == 0 && message.data[i + 1] == 0) {
          message.data[i] = message.data[i + 1] = '\xff';
          ++holes;
        }
  EXPECT_GT(holes, 0u);
  write(messages);
  expect_the_folders_bytes("--depth-scale 5000");
}

TEST_F(CliBag, ReportsUnstampedMessages) {
  for (const char* topic : {test::kTumColour, test::kTumDepth}) {
    std::vector<RecordedMessage> messages = published(true);
    for (RecordedMessage& message : messages)
      if (message.topic == topic) message.data.replace(4, 8, 8, '\0');
    write(messages);
    expect_refused(
        "", 1,
        fmt::format("all 6 images on {} have the stamp 0 in their headers: the driver does not stamp "
                    "them; give each its time of receipt (share/doc/plvo/user/ros_recordings.md)",
                    topic));
  }
  std::vector<RecordedMessage> messages =
      test::published_imu(recorded_sequence(), "/imu", test::ImuContent::kBoth);
  for (RecordedMessage& message : messages) message.data.replace(4, 8, 8, '\0');
  for (const RecordedMessage& message : published(true)) messages.push_back(message);
  write(messages);
  expect_refused("--imu", 1, "readings on /imu have the stamp 0 in their headers");
}

TEST_F(CliBag, ReportsUnreadableBags) {
  std::vector<RecordedMessage> messages = published(true);
  for (RecordedMessage& message : messages)
    if (message.topic == test::kTumColour)
      message.data =
          test::image_message(message.received_ns, 160, 120, "rgb16", 960, std::string(960 * 120, 'x'));
  write(messages);
  expect_refused("", 1,
                 "/camera/rgb/image_color: the encoding 'rgb16' is not read there; rgb8, bgr8, rgba8, "
                 "bgra8, 8UC3, mono8, bayer_…8, yuv422, or compressed is");
  for (RecordedMessage& message : messages)
    if (message.topic == test::kTumColour) message.topic = "/front/image";
  write(messages);
  expect_refused("", 1,
                 "no topic has images of colour (rgb8, bgr8, rgba8, bgra8, 8UC3, mono8, bayer_…8, yuv422, or "
                 "compressed); images are on: "
                 "/camera/depth/image (32FC1), /front/image (rgb16)");
  messages = published(true);
  write(messages);
  expect_refused("--depth-scale 1000", 1, "the depth of this bag is in metres");
  expect_refused("--tolerance 0.02 --frames 90:", 1, "the frame range is empty; the bag has frames 0:6");
  expect_refused("--scale 2", 2, "--scale: images of 160x120 scaled down by 2 are 80x60");
  expect_refused("--rate 30", 2, "does not apply to a ROS bag");
  expect_refused("--colour-topic ''", 2, "--colour-topic: expected the name of a topic");
  expect_refused("--out " + path("recording.bag"), 2, "is an input, which would be overwritten");
  const CommandResult folder = plvo("run " + recorded_sequence().string() + " --depth-topic /x");
  EXPECT_EQ(folder.exit_code, 2);
  EXPECT_NE(folder.err.find("--depth-topic: is for a ROS bag"), std::string::npos) << folder.err;
  // A damaged image costs only its frame.
  messages = published(true);
  messages[4 + 2].data.resize(1000);
  write(messages);
  const CommandResult r = run("--readout 0 --json " + path("j"));
  EXPECT_EQ(r.exit_code, 0) << r.err;
  EXPECT_NE(r.err.find("frame 1 skipped: /camera/rgb/image_color: the message ends early"), std::string::npos)
      << r.err;
  EXPECT_EQ(nlohmann::json::parse(read_file(folder_ / "j"))["damaged"], 1);
}

}  // namespace
}  // namespace plvo
