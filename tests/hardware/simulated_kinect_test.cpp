// SPDX-License-Identifier: Apache-2.0
// A simulated USB Kinect v1 below the real libusb, libfreenect and OpenNI2 and our driver and camera.
// PLVO_KINECT_SECONDS sets the duration of the run at full rate (default 6).
#include "simulated_kinect.hpp"

#include <OpenNI.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <string>
#include <thread>

#include "kinect_reference.hpp"
#include "plvo/openni2/openni2_camera.hpp"
#include "processor_time.hpp"

namespace plvo_test {
namespace {

using plvo::OpenNi2Camera;
using plvo::OpenNi2Options;
using plvo::RgbdFrame;
using plvo::Status;
using plvo::StatusCode;
using Clock = std::chrono::steady_clock;

constexpr std::size_t kPixels = SimulatedKinect::kPixels;

long resident_kB() {
  std::ifstream statm("/proc/self/statm");
  long size = 0, resident = 0;
  statm >> size >> resident;
  return resident * 4;
}

class SimulatedKinectTest : public testing::Test {
 protected:
  void open() {
    const Status status = camera_.open(options_);
    ASSERT_TRUE(status.ok()) << status.message();
  }
  Status next_frame() {
    const Clock::time_point start = Clock::now();
    Status status = camera_.next(frame_);
    while (!status.ok() && seconds_since(start) < kPatience_s) status = camera_.next(frame_);
    return status;
  }
  // Repeats the call until the camera returns this code with these words (for kPatience_s at most); returns
  // the last status.
  Status wait_for(StatusCode code, const std::string& words = "") {
    const Clock::time_point start = Clock::now();
    Status status = camera_.next(frame_);
    while ((status.code() != code || std::string(status.message()).find(words) == std::string::npos) &&
           seconds_since(start) < kPatience_s) {
      status = camera_.next(frame_);
    }
    return status;
  }
  bool colour_is(int picture) const {
    return std::memcmp(frame_.colour.data, reference_.rgb[picture].data(), kPixels * 3) == 0;
  }
  bool depth_is(int picture) const {
    return std::memcmp(frame_.depth.data, reference_.registered[picture].data(), kPixels * 2) == 0;
  }

  SimulatedKinect kinect_;
  OpenNi2Options options_;
  OpenNi2Camera camera_;
  RgbdFrame frame_;
  Reference reference_;
};

TEST_F(SimulatedKinectTest, ReportsThatNothingIsPluggedIn) {
  EXPECT_EQ(camera_.open(options_).code(), StatusCode::kNotFound);
}

TEST_F(SimulatedKinectTest, EveryByteOfColourAndRegisteredDepthArrives) {
  kinect_.plug();
  ASSERT_TRUE(reference_.take());
  open();
  EXPECT_EQ(camera_.device().uri, "freenect://1-1.3");
  EXPECT_TRUE(camera_.registered_by_device());
  int seen[SimulatedKinect::kPictures] = {};
  for (int i = 0; i < 12; ++i) {
    ASSERT_TRUE(next_frame().ok());
    const int picture = Reference::picture_of(frame_.colour.data);
    ASSERT_GE(picture, 0) << "frame " << i << ": the mosaic's own values must survive";
    EXPECT_TRUE(colour_is(picture)) << i;
    EXPECT_TRUE(depth_is(picture)) << "frame " << i << ": depth belongs to picture " << picture;
    EXPECT_NEAR(static_cast<double>(frame_.depth_stamp_ns - frame_.stamp_ns),
                static_cast<double>(SimulatedKinect::kDepthOffset_ns), 2000);
    ++seen[picture];
  }
  EXPECT_GE(*std::min_element(std::begin(seen), std::end(seen)), 1);
}

TEST_F(SimulatedKinectTest, UnregisteredDepthIsEveryPixelsDisparityInMillimetres) {
  kinect_.plug();
  ASSERT_TRUE(reference_.take());
  options_.registration = plvo::OpenNi2Registration::kNone;
  open();
  ASSERT_TRUE(next_frame().ok());
  const int picture = Reference::picture_of(frame_.colour.data);
  ASSERT_GE(picture, 0);
  std::size_t valid = 0;
  for (int y = 0; y < 480; ++y) {
    for (int x = 0; x < 640; ++x) {
      const std::uint16_t disparity = SimulatedKinect::disparity(picture, x, y);
      const std::uint16_t expected = disparity == 2047 ? 0 : reference_.raw_to_mm[disparity];
      ASSERT_EQ(frame_.depth.data[y * 640 + x], expected) << x << " " << y;
      valid += expected != 0;
    }
  }
  EXPECT_GT(valid, kPixels * 3 / 4);
}

// Runs for a bounded time through a wrap of the Kinect's clock. Every stamp is a tick of the sensor, the
// processor time suffices for the full rate, and memory does not grow.
TEST_F(SimulatedKinectTest, ReadsEveryFrameAtFullRateInFlatMemory) {
  const char* given = std::getenv("PLVO_KINECT_SECONDS");
  const double seconds = given != nullptr ? std::atof(given) : 6;
  // The clock wraps after a third of the duration.
  kinect_.plug(static_cast<std::uint32_t>(0) - static_cast<std::uint32_t>(seconds / 3 * 60e6));
  open();
  ASSERT_TRUE(next_frame().ok());
  for (int i = 0; i < 30; ++i) ASSERT_TRUE(next_frame().ok());
  const long before_kB = resident_kB();
  const std::uint64_t frames_before = camera_.counters().frames;
  const std::int64_t first_ns = frame_.stamp_ns;
  std::int64_t last_ns = first_ns;
  const ProcessorTime processor;
  const Clock::time_point start = Clock::now();
  while (seconds_since(start) < seconds) {
    ASSERT_TRUE(next_frame().ok());
    ASSERT_GT(frame_.stamp_ns, last_ns);
    const std::int64_t ticks =
        (frame_.stamp_ns - last_ns + SimulatedKinect::kFrame_ns / 2) / SimulatedKinect::kFrame_ns;
    ASSERT_GE(ticks, 1) << "more than the sensor sends";
    ASSERT_NEAR(static_cast<double>(frame_.stamp_ns - last_ns),
                static_cast<double>(ticks * SimulatedKinect::kFrame_ns),
                2000.0 + 1e-5 * static_cast<double>(ticks * SimulatedKinect::kFrame_ns));
    last_ns = frame_.stamp_ns;
  }
  const double took = seconds_since(start);
  const plvo::OpenNi2Counters counters = camera_.counters();
  const double fps = static_cast<double>(counters.frames - frames_before) / took;
  std::printf(
      "%.2f fps for %.1f s; dropped %llu colour, %llu depth; unmatched %llu, %llu; skipped %llu; memory %+ld "
      "kB\n",
      fps, took, static_cast<unsigned long long>(counters.dropped_colour),
      static_cast<unsigned long long>(counters.dropped_depth),
      static_cast<unsigned long long>(counters.unmatched_colour),
      static_cast<unsigned long long>(counters.unmatched_depth),
      static_cast<unsigned long long>(kinect_.skipped()), resident_kB() - before_kB);
  const std::uint64_t frames = counters.frames - frames_before;
  EXPECT_LE(static_cast<std::int64_t>(frames), (last_ns - first_ns) / SimulatedKinect::kFrame_ns + 1);
  if (kFiguresCount) {
    EXPECT_EQ(processor.judge(static_cast<double>(frames), SimulatedKinect::kFrame_ns * 1e-9), "");
  }
  EXPECT_EQ(counters.clock_jumps, 0u);
  if (kFiguresCount) {
    EXPECT_LT(resident_kB() - before_kB, 4096);
  }
}

TEST_F(SimulatedKinectTest, DeliversFramesAgainWhenReplugged) {
  kinect_.plug();
  ASSERT_TRUE(reference_.take());
  open();
  for (int i = 0; i < 5; ++i) ASSERT_TRUE(next_frame().ok());
  for (std::uint64_t round = 1; round <= 2; ++round) {
    const std::int64_t before_ns = frame_.stamp_ns;
    kinect_.unplug();
    Status status = wait_for(StatusCode::kUnplugged);
    EXPECT_EQ(status.code(), StatusCode::kUnplugged) << status.message();
    EXPECT_EQ(camera_.next(frame_).code(), StatusCode::kUnplugged);
    kinect_.plug();
    status = next_frame();
    ASSERT_TRUE(status.ok()) << status.message();
    EXPECT_GT(frame_.stamp_ns, before_ns);
    const int picture = Reference::picture_of(frame_.colour.data);
    ASSERT_GE(picture, 0);
    EXPECT_TRUE(depth_is(picture));
    EXPECT_EQ(camera_.counters().unplugged, round);
    EXPECT_EQ(camera_.counters().replugged, round);
  }
}

TEST_F(SimulatedKinectTest, NamesTheUdevRuleWhenPermissionIsDenied) {
  kinect_.plug();
  kinect_.deny();
  const Status status = camera_.open(options_);
  kinect_.allow();
  EXPECT_EQ(status.code(), StatusCode::kPermission) << status.message();
  EXPECT_NE(std::string(status.message()).find("60-plvo-rgbd.rules"), std::string::npos) << status.message();
}

TEST_F(SimulatedKinectTest, CameraInUseByAnotherProgram) {
  kinect_.plug();
  kinect_.set_faults({.claim_errno = EBUSY});
  const Status status = camera_.open(options_);
  EXPECT_EQ(status.code(), StatusCode::kBusy) << status.message();
  kinect_.set_faults({});
  EXPECT_TRUE(camera_.open(options_).ok()) << "as soon as the other one lets go";
}

TEST_F(SimulatedKinectTest, StampsIncreaseWhenPacketsAreLostOrCorrupted) {
  kinect_.plug();
  ASSERT_TRUE(reference_.take());
  open();
  ASSERT_TRUE(next_frame().ok());
  for (const SimulatedKinect::Faults& faults :
       {SimulatedKinect::Faults{.lose_every = 501}, SimulatedKinect::Faults{.corrupt_every = 777},
        SimulatedKinect::Faults{.error_every = 650},
        SimulatedKinect::Faults{.lose_every = 7, .corrupt_every = 5}}) {
    kinect_.set_faults(faults);
    std::int64_t last_ns = frame_.stamp_ns;
    int frames = 0;
    for (int calls = 0; calls < 30; ++calls) {
      const Status status = camera_.next(frame_);
      if (!status.ok()) {
        EXPECT_EQ(status.code(), StatusCode::kTimeout) << status.message();
        continue;
      }
      ++frames;
      EXPECT_GT(frame_.stamp_ns, last_ns);
      last_ns = frame_.stamp_ns;
    }
    EXPECT_GT(frames, faults.corrupt_every == 5 ? -1 : 0) << "some frames are whole";
  }
  kinect_.set_faults({});
  // After a few frames the damaged images have passed: complete images arrive in pairs again.
  int good = 0;
  for (int i = 0; i < 30 && good < 3; ++i) {
    ASSERT_TRUE(next_frame().ok());
    const int picture = Reference::picture_of(frame_.colour.data);
    good += picture >= 0 && colour_is(picture) && depth_is(picture);
  }
  EXPECT_EQ(good, 3);
}

TEST_F(SimulatedKinectTest, NamesTheStreamThatStopped) {
  kinect_.plug();
  open();
  ASSERT_TRUE(next_frame().ok());
  for (const bool colour : {true, false}) {
    kinect_.set_faults({.colour_stops = colour, .depth_stops = !colour});
    const char* words = colour ? "colour stream stopped" : "depth stream stopped";
    const Status status = wait_for(StatusCode::kTimeout, words);
    EXPECT_NE(std::string(status.message()).find(words), std::string::npos) << status.message();
    kinect_.set_faults({});
    EXPECT_TRUE(next_frame().ok());
  }
}

// Any OpenNI2 program may use the driver: registration before the depth stream exists, modes, properties, and
// a recording.
TEST_F(SimulatedKinectTest, AnswersOpenNi2Clients) {
  kinect_.plug();
  ASSERT_EQ(openni::OpenNI::initialize(), openni::STATUS_OK);
  {
    openni::Device device;
    ASSERT_EQ(device.open(openni::ANY_DEVICE), openni::STATUS_OK);
    EXPECT_EQ(device.setImageRegistrationMode(openni::IMAGE_REGISTRATION_DEPTH_TO_COLOR), openni::STATUS_OK);
    openni::VideoStream depth, colour;
    ASSERT_EQ(depth.create(device, openni::SENSOR_DEPTH), openni::STATUS_OK);
    ASSERT_EQ(colour.create(device, openni::SENSOR_COLOR), openni::STATUS_OK);
    EXPECT_EQ(depth.getVideoMode().getResolutionX(), 640);
    EXPECT_EQ(depth.getMaxPixelValue(), 10000);
    EXPECT_NEAR(static_cast<double>(depth.getHorizontalFieldOfView()), 1.0210, 1e-3);
    EXPECT_NEAR(static_cast<double>(colour.getHorizontalFieldOfView()), 1.0821, 1e-3);
    EXPECT_FALSE(depth.getMirroringEnabled());
    EXPECT_EQ(depth.setMirroringEnabled(false), openni::STATUS_OK);
    EXPECT_NE(depth.setMirroringEnabled(true), openni::STATUS_OK) << "refused, not ignored";
    EXPECT_EQ(device.getImageRegistrationMode(), openni::IMAGE_REGISTRATION_DEPTH_TO_COLOR);
    int stride = 0;
    EXPECT_EQ(colour.getProperty(openni::STREAM_PROPERTY_STRIDE, &stride), openni::STATUS_OK);
    EXPECT_EQ(stride, 1920);
    // Switches registration while depth is running.
    ASSERT_EQ(depth.start(), openni::STATUS_OK);
    EXPECT_EQ(device.setImageRegistrationMode(openni::IMAGE_REGISTRATION_OFF), openni::STATUS_OK);
    openni::VideoFrameRef image;
    EXPECT_EQ(depth.readFrame(&image), openni::STATUS_OK);
    EXPECT_EQ(image.getStrideInBytes(), 1280);
    image.release();
    depth.stop();
    depth.destroy();
    colour.destroy();
    device.close();
  }
  openni::OpenNI::shutdown();
}

}  // namespace
}  // namespace plvo_test
