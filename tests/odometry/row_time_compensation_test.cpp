// SPDX-License-Identifier: Apache-2.0
// A camera with increasing angular velocity observes points through a rolling shutter. The exact motion gives
// what each row shows. The features at mid-exposure must then agree with one motion between the two frames.
#include "plvo/odometry/tracking/row_time_compensation.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "plvo/base/random.hpp"

namespace plvo {
namespace {

constexpr std::int64_t kFrame_ns = 33'333'334;
constexpr double kFrame_s = 1e-9 * kFrame_ns;
constexpr double kReadout_s = 0.0261;
constexpr int kPoints = 200;

// T_camera(t)_world; angular velocity and speed change at a constant rate.
struct Motion {
  Vector3 omega, omega_rate, v;
  Se3 at(double t) const { return {rotation_exp(t * omega + 0.5 * t * t * omega_rate), t * v}; }
};

// T_to_from.
Se3 motion_between(const Motion& motion, double from, double to) {
  return motion.at(to) * motion.at(from).inverse();
}

struct Frame {
  std::vector<std::byte> memory = std::vector<std::byte>(1 << 22);
  FrameFeatures features;
  Frame() {
    Arena arena(memory);
    features.allocate(arena, Limits::vga());
  }
};

// Observes the world's points in the frame at time t, each at the exposure time of its row.
void see(const CameraModel& camera, const Motion& motion, double t, const std::vector<Vector3>& world,
         FrameFeatures& features) {
  features.points.keypoints.clear();
  features.lines.segments.clear();
  for (std::size_t i = 0; i < world.size(); ++i) {
    double delay = 0;
    Vector3 p;
    for (int step = 0; step < 20; ++step) {
      p = motion.at(t + delay) * world[i];
      delay = kReadout_s * (project(camera.pinhole, p).y() / (camera.height - 1) - 0.5);
    }
    features.points.keypoints.push_back({});
    features.points.points[i] = {p, Matrix3::Identity()};
  }
}

class RowTimeCompensationOfAPair : public testing::Test {
 protected:
  RowTimeCompensationOfAPair() {
    camera_.readout_s = kReadout_s;
    Random random(3);
    const auto uniform = [&](double low, double high) {
      return low + (high - low) * static_cast<double>(random.below(1'000'001)) * 1e-6;
    };
    for (int i = 0; i < kPoints; ++i)
      world_.push_back(back_project(camera_.pinhole, uniform(150, 500), uniform(100, 380), uniform(1, 4)));
  }

  PairTiming timing_of(const Motion& motion) const {
    PairTiming timing;
    timing.since_last_ns = kFrame_ns;
    timing.reference = {mean_velocity(motion.at(0) * motion.at(-kFrame_s).inverse(), kFrame_s), kFrame_ns};
    timing.last = timing.reference;
    return timing;
  }

  // RMS distance (m) of the current points from the moved points of the reference.
  double disagreement(const Motion& motion, const PairTiming& timing, const CameraModel& camera) {
    see(camera_, motion, 0, world_, reference_.features);
    const double interval_s =
        timing.reference_is_last ? static_cast<double>(timing.since_last_ns) * 1e-9 : kFrame_s;
    see(camera_, motion, interval_s, world_, current_.features);
    const Se3 T = motion.at(interval_s) * motion.at(0).inverse();
    std::vector<std::byte> block(1 << 20);
    Arena scratch(block);
    const RowTimeCompensation features =
        compensate_row_times(camera, timing, T, reference_.features, current_.features, scratch);
    double sum = 0;
    for (std::size_t i = 0; i < world_.size(); ++i) {
      const Vector3 now = features.current_exposure.at_mid_exposure(current_.features.points.points[i].p);
      sum += (now - T * features.reference_points[i].p).squaredNorm();
    }
    return std::sqrt(sum / kPoints);
  }

  CameraModel camera_;
  std::vector<Vector3> world_;
  Frame reference_, current_;
};

TEST_F(RowTimeCompensationOfAPair, RemovesAConstantRotationCompletely) {
  const Motion steady{{0.1, 0.9, -0.3}, Vector3::Zero(), {0.2, 0, 0.1}};
  const double raw = disagreement(steady, timing_of(steady), CameraModel{});
  const double corrected = disagreement(steady, timing_of(steady), camera_);
  EXPECT_LT(corrected, 1e-4);
  EXPECT_LT(corrected, 0.1 * raw);
}

TEST_F(RowTimeCompensationOfAPair, RemovesThreeQuartersOfAnAcceleration) {
  const Motion faster{{0, 0.3, 0}, {0, 9, 0}, Vector3::Zero()};
  const double raw = disagreement(faster, timing_of(faster), CameraModel{});
  const double corrected = disagreement(faster, timing_of(faster), camera_);
  EXPECT_GT(raw, 1e-3) << "the shutter must matter for the test to mean something";
  EXPECT_LT(corrected, 0.35 * raw);
}

TEST_F(RowTimeCompensationOfAPair, UsesOneVelocityForTheFirstPair) {
  const Motion steady{{0.1, 0.9, -0.3}, Vector3::Zero(), {0.2, 0, 0.1}};
  PairTiming first = timing_of(steady);
  first.reference = first.last = {};
  EXPECT_LT(disagreement(steady, first, camera_), 1e-4);
}

TEST_F(RowTimeCompensationOfAPair, AKeyframeKeepsItsOwnVelocity) {
  // The last good frame lies half-way; since then the angular velocity has increased.
  const Motion faster{{0, 0.3, 0}, {0, 9, 0}, Vector3::Zero()};
  PairTiming keyframe = timing_of(faster);
  keyframe.reference_is_last = false;
  keyframe.since_last_ns = kFrame_ns / 2;
  keyframe.T_reference_last = motion_between(faster, kFrame_s / 2, 0);
  keyframe.last.value = mean_velocity(motion_between(faster, 0, kFrame_s / 2), kFrame_s / 2);
  const double h = 1e-4;
  keyframe.reference.value = mean_velocity(motion_between(faster, -h, h), 2 * h);
  EXPECT_LT(disagreement(faster, keyframe, camera_), 0.35 * disagreement(faster, keyframe, CameraModel{}));
}

TEST_F(RowTimeCompensationOfAPair, TwoFramesASecondAreCompensatedAsWell) {
  const Motion steady{{0.01, 0.09, -0.03}, Vector3::Zero(), {0.2, 0, 0.1}};
  PairTiming slow = timing_of(steady);
  slow.since_last_ns = 500'000'000;
  EXPECT_LT(disagreement(steady, slow, camera_), 1e-4);
}

}  // namespace
}  // namespace plvo
