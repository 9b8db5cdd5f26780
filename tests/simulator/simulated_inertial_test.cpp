// SPDX-License-Identifier: Apache-2.0
// The simulated gyro and accelerometer against the true poses, the noise against what is stated, and
// the covered lens.
#include <algorithm>
#include <cmath>

#include "simulator_support.hpp"

namespace plvo {
namespace {

using test::small_options;

struct Samples {
  std::unique_ptr<SimulatedCamera> camera;
  std::vector<ImuSample> gyro, accelerometer;
};

Samples sample(const SimulatorOptions& options) {
  Samples samples;
  const Status status = SimulatedCamera::create(options, samples.camera);
  EXPECT_TRUE(status.ok()) << status.message();
  samples.camera->inertial_samples(samples.gyro, samples.accelerometer);
  return samples;
}

SimulatorOptions clean_options() {
  SimulatorOptions options = small_options(SceneName::kBare);
  options.frames = 90;
  options.noise = false;
  return options;
}

double seconds(std::int64_t from_ns, std::int64_t to_ns) {
  return static_cast<double>(to_ns - from_ns) * 1e-9;
}

TEST(SimulatedInertial, RatesIntegrateToTheTruePoses) {
  const Samples samples = sample(clean_options());
  const SimulatedCamera& camera = *samples.camera;
  ASSERT_EQ(samples.gyro.size(), samples.accelerometer.size());
  EXPECT_LE(samples.gyro.front().stamp_ns, camera.stamp_ns(0) - 99'000'000);
  EXPECT_GE(samples.gyro.back().stamp_ns, camera.stamp_ns(camera.frames() - 1));
  double turned = 0;
  for (std::size_t k = 1; k < samples.gyro.size(); ++k) {
    const std::int64_t before = samples.gyro[k - 1].stamp_ns, now = samples.gyro[k].stamp_ns;
    const Vector3 mean = 0.5 * (samples.gyro[k - 1].value + samples.gyro[k].value);
    const Matrix3 expected = camera.ground_truth(before).R.transpose() * camera.ground_truth(now).R;
    const Matrix3 integrated = rotation_exp(Vector3(seconds(before, now) * mean));
    EXPECT_LT(rotation_log(integrated * expected.transpose()).norm(), 2e-5) << k;
    turned += mean.norm() * seconds(before, now);
  }
  EXPECT_GT(turned, 0.2) << "the camera did turn";
}

// ∫∫ (R f + g) over a tenth of a second is what the position does beyond its velocity.
TEST(SimulatedInertial, ForcesIntegrateToTheTruePath) {
  const Samples samples = sample(clean_options());
  const SimulatedCamera& camera = *samples.camera;
  double largest = 0;
  for (std::size_t first = 0; first + 20 < samples.accelerometer.size(); first += 10) {
    Vector3 velocity = Vector3::Zero(), path = Vector3::Zero();
    Vector3 at_middle = Vector3::Zero();
    for (std::size_t k = first; k < first + 20; ++k) {
      const ImuSample& a = samples.accelerometer[k];
      const ImuSample& b = samples.accelerometer[k + 1];
      const double dt = seconds(a.stamp_ns, b.stamp_ns);
      const Vector3 down(0, 0, -9.80665);
      const Vector3 acceleration =
          0.5 * (camera.ground_truth(a.stamp_ns).R * a.value + camera.ground_truth(b.stamp_ns).R * b.value) +
          down;
      path += dt * (velocity + 0.5 * dt * acceleration);
      velocity += dt * acceleration;
      if (k == first + 9) at_middle = path;
    }
    const auto position = [&](std::size_t k) { return camera.ground_truth(samples.gyro[k].stamp_ns).t; };
    // Without the velocity at the start: x(2τ) − 2 x(τ) + x(0).
    const Vector3 expected = position(first + 20) - 2 * position(first + 10) + position(first);
    const Vector3 integrated = path - 2 * at_middle;
    EXPECT_LT((integrated - expected).norm(), 2e-5) << first;
    largest = std::max(largest, expected.norm());
  }
  EXPECT_GT(largest, 5e-4) << "the camera was accelerated";
}

TEST(SimulatedInertial, NoiseAndOffsetsAreAsStated) {
  SimulatorOptions options = clean_options();
  options.frames = 300;
  const Samples exact = sample(options);
  double offset_gyro = 0, offset_accelerometer = 0, noise_gyro = 0, noise_accelerometer = 0;
  constexpr int kSeeds = 12;
  options.noise = true;
  const InertialOptions& stated = options.inertial;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    options.seed = static_cast<std::uint64_t>(seed);
    SimulatorOptions quiet = options;
    quiet.noise = false;
    const Samples noisy = sample(options), clean = sample(quiet);
    const auto spread = [](const std::vector<ImuSample>& a, const std::vector<ImuSample>& b, double& offset,
                           double& noise) {
      const auto count = static_cast<double>(a.size());
      Vector3 mean = Vector3::Zero();
      for (std::size_t k = 0; k < a.size(); ++k) mean += (a[k].value - b[k].value) / count;
      offset += mean.squaredNorm() / (3 * kSeeds);
      for (std::size_t k = 0; k < a.size(); ++k)
        noise += (a[k].value - b[k].value - mean).squaredNorm() / (3 * kSeeds * count);
    };
    spread(noisy.gyro, clean.gyro, offset_gyro, noise_gyro);
    spread(noisy.accelerometer, clean.accelerometer, offset_accelerometer, noise_accelerometer);
  }
  const double root_rate = std::sqrt(stated.rate_hz);
  EXPECT_NEAR(std::sqrt(noise_gyro) / (stated.gyro_noise * root_rate), 1, 0.05);
  EXPECT_NEAR(std::sqrt(noise_accelerometer) / (stated.accelerometer_noise * root_rate), 1, 0.05);
  EXPECT_NEAR(std::sqrt(offset_gyro) / stated.gyro_offset_sigma, 1, 0.4);
  EXPECT_NEAR(std::sqrt(offset_accelerometer) / stated.accelerometer_offset_sigma, 1, 0.4);
  EXPECT_GT(exact.gyro.size(), 2000U);
}

TEST(SimulatedCamera, ACoveredLensIsBlackAndWithoutDepth) {
  SimulatorOptions options = small_options(SceneName::kDesk);
  options.covered_first = 1;
  options.covered_end = 3;
  const std::vector<test::Shot> covered = test::shoot(options);
  options.covered_end = options.covered_first = 0;
  const std::vector<test::Shot> open = test::shoot(options);
  for (std::size_t k = 0; k < 4; ++k) {
    const bool dark = k == 1 || k == 2;
    EXPECT_EQ(covered[k].colour == open[k].colour, !dark) << k;
    EXPECT_EQ(covered[k].depth == open[k].depth, !dark) << k;
    EXPECT_EQ(std::count(covered[k].depth.begin(), covered[k].depth.end(), 0) ==
                  static_cast<std::ptrdiff_t>(covered[k].depth.size()),
              dark);
  }
  options.covered_first = 5;
  EXPECT_EQ(options.validate().code(), StatusCode::kInvalidArgument) << "a range that ends before it begins";
}

}  // namespace
}  // namespace plvo
