// SPDX-License-Identifier: Apache-2.0
// One odometry over many frames: laps of the procedural sequence, there and back, with frames in the dark.
// The suite tracks a few laps; PLVO_SOAK_FRAMES=100000 build/release/tests/odometry_soak_test tracks as many
// frames as it says. What the process holds does not grow, every lap finds its way, and a lap that starts
// anew in memory that has seen all the others gives the bits of the first.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "fingerprint.hpp"
#include "plvo/host/posix_clock.hpp"
#include "plvo/host/resident_memory.hpp"
#include "plvo/odometry/odometry.hpp"
#include "procedural_sequence.hpp"

namespace plvo {
namespace {

constexpr Limits kLimits = Limits::qvga();
constexpr int kFramesOneWay = 30;
constexpr int kFramesOfALap = 2 * kFramesOneWay;
constexpr int kDarkFrame = 17;  // of a lap

int frames_to_track() {
  const char* wanted = std::getenv("PLVO_SOAK_FRAMES");
  return wanted == nullptr ? 8 * kFramesOfALap : std::max(std::atoi(wanted), 3 * kFramesOfALap);
}

// The images of a lap, rendered once: rendering takes longer than tracking.
class Lap {
 public:
  Lap() : sequence_(kLimits.width, kLimits.height) {
    for (int i = 0; i <= kFramesOneWay; ++i) {
      const RgbdFrame frame = i == kFramesOneWay ? sequence_.render_dark(i) : sequence_.render(i);
      colours_.emplace_back(frame.colour.data, frame.colour.data + 3 * kPixels);
      depths_.emplace_back(frame.depth.data, frame.depth.data + kPixels);
      frame_ = frame;
    }
  }
  const CameraModel& camera() const { return sequence_.camera(); }
  // i-th of the lap, as the number-th of the sequence.
  RgbdFrame frame(int i, std::int64_t number) {
    const int place = i < kFramesOneWay ? i : kFramesOfALap - 1 - i;
    const auto image = static_cast<std::size_t>(i == kDarkFrame ? kFramesOneWay : place);
    frame_.colour.data = colours_[image].data();
    frame_.depth.data = depths_[image].data();
    frame_.stamp_ns = frame_.depth_stamp_ns = 33'333'333 * (number + 1);
    return frame_;
  }

 private:
  static constexpr std::ptrdiff_t kPixels = std::ptrdiff_t{kLimits.width} * kLimits.height;

  ProceduralSequence sequence_;
  RgbdFrame frame_;
  std::vector<std::vector<std::uint8_t>> colours_;
  std::vector<std::vector<std::uint16_t>> depths_;
};

struct LapResult {
  int tracked = 0, lost = 0;
  std::uint64_t bits = 0;
  double cpu_ms = 0;  // the median frame's
};

class Soak : public ::testing::Test {
 protected:
  Soak() : memory_(required_bytes(kLimits)) {}

  void start() {
    ASSERT_TRUE(odometry_.init(memory_, lap_.camera(), Config{}, kLimits).ok());
    number_ = 0;
  }
  LapResult track_lap() {
    LapResult done;
    Fingerprint print;
    std::array<std::int64_t, kFramesOfALap> took{};
    for (int i = 0; i < kFramesOfALap; ++i) {
      const RgbdFrame frame = lap_.frame(i, number_++);
      const std::int64_t start = posix_thread_cpu_ns();
      const TrackResult result = odometry_.track(frame);
      took[static_cast<std::size_t>(i)] = posix_thread_cpu_ns() - start;
      done.tracked += result.state == TrackState::kTracking ? 1 : 0;
      done.lost += result.state == TrackState::kLost ? 1 : 0;
      print.add(result.T_world_camera.R);
      print.add(result.T_world_camera.t);
      print.add(result.pose_covariance);
      EXPECT_TRUE(result.T_world_camera.is_finite() && result.pose_covariance.allFinite()) << number_;
    }
    std::nth_element(took.begin(), took.begin() + kFramesOneWay, took.end());
    done.bits = print.value();
    done.cpu_ms = static_cast<double>(took[kFramesOneWay]) * 1e-6;
    return done;
  }

  Lap lap_;
  std::vector<std::byte> memory_;
  Odometry odometry_;
  std::int64_t number_ = 0;
};

TEST_F(Soak, MemoryIsFlatAndTheLastLapIsAsTheFirst) {
  const int laps = frames_to_track() / kFramesOfALap;
  start();
  const LapResult first = track_lap();
  EXPECT_EQ(first.lost, 1);
  EXPECT_EQ(first.tracked, kFramesOfALap - 2);
  (void)track_lap();
  prefault_program();
  const std::int64_t before = resident_memory().anonymous;
  const std::size_t peak = odometry_.memory_peak();
  LapResult last;
  for (int lap = 2; lap < laps - 1; ++lap) {
    last = track_lap();
    ASSERT_EQ(last.lost, 1) << "lap " << lap;
    ASSERT_EQ(last.tracked, kFramesOfALap - 1) << "lap " << lap;
  }
  EXPECT_EQ(odometry_.memory_peak(), peak);
  EXPECT_LE(resident_memory().anonymous - before, 64 * 1024);
  start();
  EXPECT_EQ(track_lap().bits, first.bits);
  std::printf(
      "%d frames; the median frame's CPU time: %.2f ms in the first lap, %.2f in the last; hash %016llx\n",
      laps * kFramesOfALap, first.cpu_ms, last.cpu_ms, static_cast<unsigned long long>(first.bits));
}

}  // namespace
}  // namespace plvo
