// SPDX-License-Identifier: Apache-2.0
// A simulated robot: its camera stays level, its wheels drive the true path, and their noise and slip are
// those that are stated.
#include <cmath>

#include "simulator_support.hpp"

namespace plvo {
namespace {

using test::small_options;

std::unique_ptr<SimulatedCamera> robot(bool noise, SceneName scene = SceneName::kHall,
                                       std::uint64_t seed = 1) {
  SimulatorOptions options = small_options(scene);
  options.frames = 150;
  options.seed = seed;
  options.noise = noise;
  options.robot = true;
  std::unique_ptr<SimulatedCamera> camera;
  const Status status = SimulatedCamera::create(options, camera);
  EXPECT_TRUE(status.ok()) << status.message();
  return camera;
}

std::vector<WheelSample> wheels_of(const SimulatedCamera& camera) {
  std::vector<WheelSample> samples;
  camera.wheel_samples(samples);
  return samples;
}

TEST(SimulatedWheels, TheCameraOfARobotIsLevelButForTheRumble) {
  for (const SceneName scene : {SceneName::kCorridor, SceneName::kHall, SceneName::kBare}) {
    const auto camera = robot(true, scene);
    const double height = camera->pose(0).t.z();
    for (int i = 0; i < camera->frames(); ++i) {
      const Se3 T = camera->pose(i);
      EXPECT_NEAR(T.t.z(), height, 0.005) << i;
      EXPECT_NEAR(T.R(2, 1), -1, 1e-4) << "its y axis points down";
    }
  }
}

TEST(SimulatedWheels, VelocitiesIntegrateToTheTruePath) {
  const auto camera = robot(false);
  const std::vector<WheelSample> samples = wheels_of(*camera);
  const Se3 T_camera_base = robot_camera().inverse();
  EXPECT_LE(samples.front().stamp_ns, camera->stamp_ns(0) - 99'000'000);
  EXPECT_GE(samples.back().stamp_ns, camera->stamp_ns(camera->frames() - 1));
  const auto base_at = [&](std::int64_t stamp_ns) { return camera->ground_truth(stamp_ns) * T_camera_base; };
  double driven_m = 0;
  for (std::size_t k = 1; k < samples.size(); ++k) {
    const double dt = static_cast<double>(samples[k].stamp_ns - samples[k - 1].stamp_ns) * 1e-9;
    const Vector3 v = 0.5 * (samples[k - 1].velocity + samples[k].velocity);
    const Se3 T = base_at(samples[k - 1].stamp_ns).inverse() * base_at(samples[k].stamp_ns);
    // What the wheels do not measure, the rumble of the floor, is a millimetre and a few milliradians; it
    // moves a base that is half a metre below the camera by as much.
    EXPECT_NEAR(T.t.x(), dt * v.x(), 1e-4) << k;
    EXPECT_NEAR(T.t.y(), dt * v.y(), 1e-4) << k;
    EXPECT_NEAR(rotation_log(T.R).z(), dt * v.z(), 1e-4) << k;
    driven_m += dt * v.head<2>().norm();
  }
  EXPECT_GT(driven_m, 1.5);
}

TEST(SimulatedWheels, NoiseAndSlipAreAsStated) {
  double squares = 0;
  int quiet = 0, slipping = 0, all = 0;
  const SimulatedWheels stated;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    const auto noisy = robot(true, SceneName::kHall, seed), exact = robot(false, SceneName::kHall, seed);
    const std::vector<WheelSample> a = wheels_of(*noisy), b = wheels_of(*exact);
    ASSERT_EQ(a.size(), b.size());
    EXPECT_EQ(wheels_of(*robot(true, SceneName::kHall, seed))[7].velocity, a[7].velocity) << "the seed's";
    for (std::size_t k = 0; k < a.size(); ++k) {
      const Vector3 error = a[k].velocity - b[k].velocity;
      const double turn_by_slip = stated.slip * std::abs(b[k].velocity.x()) / stated.track_m;
      ++all;
      if (turn_by_slip > 0.1 && std::abs(error.z()) > 0.5 * turn_by_slip + 0.05) ++slipping;
      if (std::abs(b[k].velocity.y()) > 0.08) continue;
      squares += error.y() * error.y();
      ++quiet;
    }
  }
  ASSERT_GT(quiet, 50);
  EXPECT_NEAR(std::sqrt(squares / quiet), stated.noise_mps, 0.0015);
  EXPECT_GT(slipping, all / 50);
  EXPECT_LT(slipping, all / 4);
}

TEST(SimulatedWheels, ARobotDrivesNoRecordedTrajectory) {
  SimulatorOptions options = small_options(SceneName::kHall);
  options.robot = true;
  options.trajectory_file = "t.txt";
  EXPECT_NE(std::string(options.validate().message()).find("a robot drives"), std::string::npos);
  options.trajectory_file.clear();
  options.wheels.rate_hz = 0;
  EXPECT_NE(std::string(options.validate().message()).find("rate of the wheels"), std::string::npos);
}

}  // namespace
}  // namespace plvo
