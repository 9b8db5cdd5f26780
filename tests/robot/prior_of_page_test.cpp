// SPDX-License-Identifier: Apache-2.0
// The lines of docs/user/robots.md that track with a gyro and an accelerometer: a covered lens is bridged,
// and the gyro's offset is learnt.
#include <gtest/gtest.h>

#include <vector>

#include "plvo/inertial/imu_integrator.hpp"
#include "plvo/odometry/odometry.hpp"
#include "procedural_sequence.hpp"
#include "test_limits.hpp"

namespace plvo {
namespace {

TrackResult track_as_the_page(Odometry& odometry, ImuIntegrator& imu, const RgbdFrame& frame,
                              std::int64_t stamp_ns, const Vector3& rate, const Vector3& force) {
#include "prior_of_page.inc"
  return result;
}

TEST(PriorOfThePage, BridgesACoveredLensAndLearnsTheOffset) {
  ProceduralSequence sequence{320, 240};
  std::vector<std::byte> memory(required_bytes(test::kTestLimits));
  Odometry odometry;
  ASSERT_TRUE(odometry.init(memory, sequence.camera(), {}, test::kTestLimits).ok());
  std::vector<ImuSample> gyro(8), accelerometer(8);
  ImuIntegrator imu;
  ASSERT_TRUE(imu.init(gyro, accelerometer).ok());
  const Vector3 offset(0.02, -0.01, 0.015);
  for (int i = 0; i < 12; ++i) {
    const Matrix3 R_world_now = ProceduralSequence::T_world_camera(i).R;
    const Matrix3 R_before_now = ProceduralSequence::T_world_camera(i - 1).R.transpose() * R_world_now;
    const RgbdFrame frame = i == 8 ? sequence.render_dark(i) : sequence.render(i);
    const TrackResult result =
        track_as_the_page(odometry, imu, frame, frame.stamp_ns, 30 * rotation_log(R_before_now) + offset,
                          R_world_now.transpose() * Vector3(0, -9.8, 0));
    EXPECT_EQ(result.state, i == 0   ? TrackState::kInitialising
                            : i == 8 ? TrackState::kPredicted
                                     : TrackState::kTracking)
        << i;
  }
  EXPECT_LT((imu.gyro_offset() - offset).norm(), 0.8 * offset.norm()) << imu.gyro_offset().transpose();
}

}  // namespace
}  // namespace plvo
