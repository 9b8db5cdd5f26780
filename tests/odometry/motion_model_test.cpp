// SPDX-License-Identifier: Apache-2.0
// The motion model against a simulated random walk: its estimates of a velocity from the means over two
// intervals are those with the least mean square error.
#include "plvo/odometry/motion_model.hpp"

#include <gtest/gtest.h>

#include "simulated_pair.hpp"

namespace plvo {
namespace {

constexpr std::int64_t kStep_ns = 1'000'000;

// One axis of a velocity in steps of a millisecond; its means over two intervals of the same length.
struct SimulatedVelocity {
  SimulatedVelocity(test::Gaussian& gaussian, int steps) {
    double velocity = 0;
    for (int i = 0; i < steps; ++i) before += (velocity += gaussian()) / steps;
    between = velocity;
    for (int i = 0; i < steps; ++i) after += (velocity += gaussian()) / steps;
    end = velocity;
  }
  double before = 0, between = 0, after = 0, end = 0;
};

Velocity along_x(double value, int steps) {
  Velocity velocity;
  velocity.value[0] = value;
  velocity.measured_ns = steps * kStep_ns;
  return velocity;
}

// The share `w` for which after + w (after − before) has the least square error.
template <typename True>
double best_share(int steps, const True& truth) {
  test::Gaussian gaussian(5);
  double product = 0, square = 0;
  for (int trial = 0; trial < 20'000; ++trial) {
    const SimulatedVelocity velocity(gaussian, steps);
    const double difference = velocity.after - velocity.before;
    product += (truth(velocity) - velocity.after) * difference;
    square += difference * difference;
  }
  return product / square;
}

TEST(MotionModel, EstimatesOfARandomWalkHaveTheLeastError) {
  constexpr int kSteps = 60;
  const Velocity a = along_x(0, kSteps), b = along_x(1, kSteps);
  EXPECT_NEAR(velocity_at_exposure(b, a)[0] - 1,
              best_share(kSteps, [](const SimulatedVelocity& v) { return v.end; }), 0.02);
  EXPECT_NEAR(velocity_between(a, b)[0] - 1,
              best_share(kSteps, [](const SimulatedVelocity& v) { return v.between; }), 0.02);
}

TEST(MotionModel, UsesTheOneVelocityThatIsKnown) {
  const Velocity known = along_x(2, 30), unknown;
  EXPECT_EQ(velocity_at_exposure(known, unknown)[0], 2);
  EXPECT_EQ(velocity_between(known, unknown)[0], 2);
  EXPECT_EQ(velocity_between(unknown, known)[0], 2);
}

TEST(MotionModel, ACameraCoastsForThreeIntervalsAndThenStandsStill) {
  const Velocity slow = along_x(1, 200), fast = along_x(1, 33);
  EXPECT_DOUBLE_EQ(slow.moving_s(400 * kStep_ns), 0.4);
  EXPECT_DOUBLE_EQ(slow.moving_s(5000 * kStep_ns), 0.6);
  EXPECT_DOUBLE_EQ(fast.moving_s(5000 * kStep_ns), 0.3) << "300 ms at least";
  EXPECT_EQ(Velocity().moving_s(100 * kStep_ns), 0);
  EXPECT_DOUBLE_EQ(coasted_motion(fast, 100 * kStep_ns).t.x(), 0.1);
  // Stamps may be any: the longest possible interval does not overflow.
  Velocity endless = along_x(1, 1);
  endless.measured_ns = INT64_MAX;
  EXPECT_GT(endless.moving_s(INT64_MAX), 9e9);
}

}  // namespace
}  // namespace plvo
