// SPDX-License-Identifier: Apache-2.0
// Recordings of OpenNI2: the camera plays every frame that the recorder has written, however slow the reader
// is.
#include <sys/stat.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <thread>

#include "plvo/base/random.hpp"
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
  // The format has no stamp that both streams share (openni2_recorder.hpp). A recording that begins between
  // the two images of a tick pairs images of different ticks, so this one begins while the device is stalled.
  Status start(plvo::OpenNi2Recorder& recorder) {
    EXPECT_TRUE(device_.command("stall"));
    // The current tick still delivers its images.
    for (const std::int64_t over = device_.ticks() + 2; device_.ticks() < over;)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    const Status status = recorder.start(camera_, path_);
    EXPECT_TRUE(device_.command("run"));
    return status;
  }
  // Records while it reads `count` frames; returns the ticks of these frames.
  std::vector<int> record(int count) {
    open();
    EXPECT_TRUE(next_frame().ok());
    plvo::OpenNi2Recorder recorder;
    const Status status = start(recorder);
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
  // Opens the file and reads until a status is not ok, which must happen soon. Returns that status.
  Status play_to_the_end(int* opened = nullptr) {
    OpenNi2Options options;
    options.uri = path_;
    options.timeout_ms = 300;
    Status status = camera_.open(options);
    if (!status.ok()) return status;
    if (opened != nullptr) ++*opened;
    int frames = 0;
    int damaged = 0;
    while (frames < 100 && damaged < 1000) {
      status = camera_.next(frame_);
      if (status.ok()) {
        ++frames;
      } else if (status.code() == StatusCode::kDamaged) {
        ++damaged;
      } else {
        break;
      }
    }
    EXPECT_LT(frames, 100);
    EXPECT_FALSE(status.ok());
    camera_.close();
    return status;
  }
  std::string read_bytes() const {
    std::ifstream file(path_, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  // Process id of the only child; 0 if there is none.
  static pid_t only_child() {
    std::ifstream file("/proc/self/task/" + std::to_string(::getpid()) + "/children");
    pid_t child = 0;
    file >> child;
    return file ? child : 0;
  }
  std::filesystem::path folder_;
  std::string path_;
};

TEST_F(OniFileTest, PlaysEveryRecordedFrame) {
  const std::vector<int> read = record(12);
  const std::vector<int> played = play(std::chrono::milliseconds(0));
  // The recorder follows the sensor's rate, not the reader's: it may record more frames at both ends, and it
  // records every frame in between.
  ASSERT_GE(played.size(), read.size() - 2);
  for (std::size_t i = 1; i < played.size(); ++i) EXPECT_EQ(played[i], (played[i - 1] + 1) % 256) << i;
  EXPECT_NE(std::find(played.begin(), played.end(), read[read.size() / 2]), played.end());
  EXPECT_EQ(camera_.counters().unmatched_colour + camera_.counters().unmatched_depth, 0u);
  EXPECT_EQ(camera_.counters().missing, 0u);
  EXPECT_EQ(camera_.recorded_frames(), static_cast<int>(played.size()));

  // The end of the stream persists, and a slow reader gets the same frames.
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
  ASSERT_TRUE(start(recorder).ok());
  for (int i = 0; i < 5; ++i) ASSERT_TRUE(next_frame().ok());
  ASSERT_TRUE(device_.command("unplug"));
  EXPECT_EQ(wait_for(StatusCode::kUnplugged).code(), StatusCode::kUnplugged);
  EXPECT_FALSE(recorder.recording());
  camera_.close();
  EXPECT_GE(play(std::chrono::milliseconds(0)).size(), 3u);
}

TEST_F(OniFileTest, RefusalsGiveTheReason) {
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

TEST_F(OniFileTest, ReportsMissingAndBrokenFiles) {
  OpenNi2Options options;
  options.uri = folder_ / "none.oni";
  EXPECT_EQ(camera_.open(options).code(), StatusCode::kNotFound);
  options.uri = folder_ / "pipe.oni";
  ASSERT_EQ(::mkfifo(options.uri.c_str(), 0600), 0);
  EXPECT_EQ(camera_.open(options).code(), StatusCode::kInvalidArgument);
  options.uri = folder_ / "rubbish.oni";
  std::ofstream(options.uri) << "this is no recording";
  const Status status = camera_.open(options);
  EXPECT_EQ(status.code(), StatusCode::kDamaged) << status.message();
}

// A truncated recording (power failure) gives a status in bounded time and no crash.
TEST_F(OniFileTest, TruncatedFilesGiveAStatus) {
  record(6);
  const auto whole = std::filesystem::file_size(path_);
  for (const auto part : {whole - 1, whole - 5000, whole / 2, whole / 10, std::uintmax_t{200}}) {
    std::filesystem::resize_file(path_, part);
    EXPECT_FALSE(play_to_the_end().ok());
  }
}

// OpenNI2 trusts the headers of a file. Since another process reads them, a damaged header cannot crash this
// one.
TEST_F(OniFileTest, DamagedHeadersAreAStatus) {
  options_.width = 320;
  options_.height = 240;
  record(4);
  const std::string whole = read_bytes();
  const char* given = std::getenv("PLVO_ONI_DAMAGES");
  const int damages = given != nullptr ? std::atoi(given) : 40;
  plvo::Random random(11);
  int opened = 0;
  int crashed = 0;
  for (int i = 0; i < damages; ++i) {
    std::string bytes = whole;
    // Damages mostly the first kilobytes, where headers are dense, and sometimes any place.
    const std::size_t range = i % 4 == 3 ? bytes.size() : std::min<std::size_t>(bytes.size(), 2000);
    for (std::uint32_t n = 1 + random.below(4); n > 0; --n) {
      const std::size_t at = random.below(static_cast<std::uint32_t>(range));
      bytes[at] = static_cast<char>(random.below(3) == 0 ? 255 : random.below(256));
    }
    std::ofstream(path_, std::ios::binary) << bytes;
    const Status end = play_to_the_end(&opened);
    if (std::strstr(end.message(), "crashed") != nullptr) ++crashed;
  }
  RecordProperty("opened", opened);
  RecordProperty("crashed", crashed);
  std::cerr << damages << " damaged files: " << opened << " opened, " << crashed << " crashed the player\n";
}

// The child may die in the middle of a recording, for any reason.
TEST_F(OniFileTest, ThePlayersDeathIsAStatus) {
  record(30);
  OpenNi2Options options;
  options.uri = path_;
  ASSERT_TRUE(camera_.open(options).ok());
  ASSERT_TRUE(camera_.next(frame_).ok());
  const pid_t child = only_child();
  ASSERT_GT(child, 0);
  ASSERT_EQ(::kill(child, SIGSEGV), 0);
  Status status;
  while ((status = camera_.next(frame_)).ok()) {
  }
  EXPECT_EQ(status.code(), StatusCode::kIo) << status.message();
  EXPECT_NE(std::strstr(status.message(), "crashed (Segmentation fault)"), nullptr) << status.message();
  EXPECT_NE(std::strstr(status.message(), path_.c_str()), nullptr) << status.message();
  EXPECT_EQ(camera_.next(frame_).code(), StatusCode::kIo) << "and it stays so";
  camera_.close();
  EXPECT_EQ(only_child(), 0);
}

TEST_F(OniFileTest, ClosingEndsThePlayer) {
  record(10);
  OpenNi2Options options;
  options.uri = path_;
  ASSERT_TRUE(camera_.open(options).ok());
  EXPECT_GT(only_child(), 0);
  camera_.close();
  EXPECT_EQ(only_child(), 0);
}

// A program whose main() does not handle the player role must not start itself endlessly.
TEST_F(OniFileTest, ProgramWithoutAPlayerReportsIt) {
  record(2);
  OpenNi2Options options;
  options.uri = path_;
  options.oni_player = "/bin/true";
  EXPECT_EQ(camera_.open(options).code(), StatusCode::kDamaged);
  options.oni_player = "/nowhere/plvo";
  EXPECT_EQ(camera_.open(options).code(), StatusCode::kIo);
  options.oni_player.clear();
  ASSERT_EQ(::setenv("PLVO_ONI_PLAYER", "1", 1), 0);
  const Status status = camera_.open(options);
  ::unsetenv("PLVO_ONI_PLAYER");
  EXPECT_EQ(status.code(), StatusCode::kUnsupported);
  EXPECT_NE(std::strstr(status.message(), "play_oni_if_asked"), nullptr) << status.message();
}

// A player that a damaged file has compromised may do nothing, send nonsense, or close the connection and
// keep running.
TEST_F(OniFileTest, InvalidMessagesOfThePlayerAreErrors) {
  record(2);
  OpenNi2Options options;
  options.uri = path_;
  options.oni_player = folder_ / "player.sh";
  options.oni_patience_ms = 200;
  const auto plays = [&](const std::string& script, const char* words) {
    std::ofstream(options.oni_player) << "#!/bin/sh\n" << script << "\n";
    std::filesystem::permissions(options.oni_player, std::filesystem::perms::owner_all);
    const Status status = camera_.open(options);
    EXPECT_FALSE(status.ok());
    EXPECT_NE(std::strstr(status.message(), words), nullptr) << script << ": " << status.message();
    EXPECT_EQ(only_child(), 0);
  };
  plays("exec sleep 1000", "does not finish reading");
  options.oni_patience_ms = 60000;
  plays("exec head -c 1000 /dev/zero >&0", "something that is not a message");
  plays("exit 7", "ended (exit code 7)");
  plays("kill -BUS $$", "crashed (Bus error)");
  plays("exec sleep 1000 <&-", "crashed (Killed)");
}

TEST_F(OniFileTest, PlayedFilesAreNotRecordedAsOni) {
  record(2);
  OpenNi2Options options;
  options.uri = path_;
  ASSERT_TRUE(camera_.open(options).ok());
  plvo::OpenNi2Recorder recorder;
  EXPECT_EQ(recorder.start(camera_, folder_ / "b.oni").code(), StatusCode::kUnsupported);
}

}  // namespace
}  // namespace plvo_test
