// SPDX-License-Identifier: Apache-2.0
// Recordings of OpenNI2: what the recorder writes, the camera plays, every frame of it, however slow the
// reader is.
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <thread>

#include "plvo/openni2/openni2_recorder.hpp"
#include "virtual_device_fixture.hpp"

namespace plvo_test {
namespace {

class OniFileTest : public VirtualDeviceTest {
 protected:
  void SetUp() override {
    VirtualDeviceTest::SetUp();
    folder_ = std::filesystem::temp_directory_path() / ("plvo_oni_" + std::to_string(::getpid()));
    std::filesystem::create_directory(folder_);
    path_ = folder_ / "recording.oni";
  }
  void TearDown() override {
    VirtualDeviceTest::TearDown();
    std::filesystem::remove_all(folder_);
  }
  // Records while `count` frames are read; returns the ticks that were read.
  std::vector<int> record(int count) {
    open();
    EXPECT_TRUE(next_frame().ok());
    plvo::OpenNi2Recorder recorder;
    const Status status = recorder.start(camera_, path_);
    EXPECT_TRUE(status.ok()) << status.message();
    std::vector<int> ticks;
    for (int i = 0; i < count; ++i) {
      EXPECT_TRUE(next_frame().ok());
      ticks.push_back(colour_tick());
    }
    recorder.stop();
    camera_.close();
    return ticks;
  }
  std::vector<int> play(std::chrono::milliseconds pause) {
    OpenNi2Options options;
    options.uri = path_;
    options.timeout_ms = 3000;
    const Status status = camera_.open(options);
    EXPECT_TRUE(status.ok()) << status.message();
    std::vector<int> ticks;
    std::int64_t last_ns = -1;
    while (status.ok()) {
      const Status next = camera_.next(frame_);
      if (!next.ok()) {
        EXPECT_EQ(next.code(), StatusCode::kEndOfStream) << next.message();
        break;
      }
      EXPECT_GT(frame_.stamp_ns, last_ns);
      last_ns = frame_.stamp_ns;
      EXPECT_EQ(colour_tick(), depth_tick() % 256);
      ticks.push_back(colour_tick());
      std::this_thread::sleep_for(pause);
    }
    return ticks;
  }
  std::filesystem::path folder_;
  std::string path_;
};

TEST_F(OniFileTest, PlaysWhatWasRecordedWithoutLoss) {
  const std::vector<int> read = record(12);
  const std::vector<int> played = play(std::chrono::milliseconds(0));
  // The recorder works on the sensor's pace, not on the reader's: it may hold more at either end, and nothing
  // less in between.
  ASSERT_GE(played.size(), read.size() - 2);
  for (std::size_t i = 1; i < played.size(); ++i) EXPECT_EQ(played[i], (played[i - 1] + 1) % 256) << i;
  EXPECT_NE(std::find(played.begin(), played.end(), read[read.size() / 2]), played.end());
  EXPECT_EQ(camera_.counters().unmatched_colour + camera_.counters().unmatched_depth, 0u);
  EXPECT_EQ(camera_.counters().missing, 0u);
  EXPECT_EQ(camera_.recorded_frames(), static_cast<int>(played.size()));

  // The end stays the end, and a slow reader gets the same frames.
  EXPECT_EQ(camera_.next(frame_).code(), StatusCode::kEndOfStream);
  EXPECT_EQ(play(std::chrono::milliseconds(60)), played);
}

TEST_F(OniFileTest, FieldOfViewAndModeComeFromTheFile) {
  options_.width = 320;
  options_.height = 240;
  record(3);
  ASSERT_TRUE(device_.command("unplug"));
  OpenNi2Options options;
  options.uri = path_;
  const Status status = camera_.open(options);
  ASSERT_TRUE(status.ok()) << status.message();
  EXPECT_EQ(camera_.model().width, 320);
  EXPECT_NEAR(camera_.model().pinhole.fx, 160 / std::tan(1.0226 / 2), 1e-3);
  EXPECT_TRUE(camera_.registered_by_device());
  EXPECT_TRUE(next_frame().ok());
}

TEST_F(OniFileTest, UnplugEndsTheRecordingWithAValidFile) {
  open();
  ASSERT_TRUE(next_frame().ok());
  plvo::OpenNi2Recorder recorder;
  ASSERT_TRUE(recorder.start(camera_, path_).ok());
  for (int i = 0; i < 5; ++i) ASSERT_TRUE(next_frame().ok());
  ASSERT_TRUE(device_.command("unplug"));
  EXPECT_EQ(wait_for(StatusCode::kUnplugged).code(), StatusCode::kUnplugged);
  EXPECT_FALSE(recorder.recording());
  camera_.close();
  EXPECT_GE(play(std::chrono::milliseconds(0)).size(), 3u);
}

TEST_F(OniFileTest, RefusalsSayWhy) {
  plvo::OpenNi2Recorder recorder;
  EXPECT_EQ(recorder.start(camera_, path_).code(), StatusCode::kInvalidArgument) << "no camera";
  open();
  EXPECT_EQ(recorder.start(camera_, folder_ / "recording.avi").code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(recorder.start(camera_, folder_ / "missing" / "a.oni").code(), StatusCode::kIo);
  camera_.close();
  ASSERT_TRUE(device_.command("registration 0"));
  open();
  EXPECT_EQ(recorder.start(camera_, path_).code(), StatusCode::kUnsupported);
  EXPECT_FALSE(recorder.recording());
}

TEST_F(OniFileTest, MissingAndBrokenFiles) {
  OpenNi2Options options;
  options.uri = folder_ / "none.oni";
  EXPECT_EQ(camera_.open(options).code(), StatusCode::kNotFound);
  options.uri = folder_ / "rubbish.oni";
  std::ofstream(options.uri) << "this is no recording";
  const Status status = camera_.open(options);
  EXPECT_EQ(status.code(), StatusCode::kDamaged) << status.message();
}

// A recording that was cut off (a power failure): some status, in bounded time, and no crash.
TEST_F(OniFileTest, TruncatedFilesEnd) {
  record(6);
  const auto whole = std::filesystem::file_size(path_);
  for (const auto part : {whole - 1, whole - 5000, whole / 2, whole / 10, std::uintmax_t{200}}) {
    std::filesystem::resize_file(path_, part);
    OpenNi2Options options;
    options.uri = path_;
    options.timeout_ms = 300;
    if (!camera_.open(options).ok()) continue;
    int frames = 0;
    while (camera_.next(frame_).ok() && frames < 100) ++frames;
    EXPECT_LT(frames, 100);
    camera_.close();
  }
}

}  // namespace
}  // namespace plvo_test
