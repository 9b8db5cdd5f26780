// SPDX-License-Identifier: Apache-2.0
// Constraints from two depth images: a corridor and a room, ray-cast with a Kinect's noise, before and after
// a known motion. Also the odometry with surfaces: the same bits again, and memory only if Limits ask for it.
#include "plvo/odometry/tracking/surface_tracking.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "depth_picture.hpp"
#include "plvo/motion/motion_problem.hpp"
#include "plvo/odometry/odometry.hpp"
#include "plvo/surfaces/surface_sampling.hpp"
#include "procedural_sequence.hpp"
#include "simulated_pair.hpp"

namespace plvo {
namespace {

using test::DepthPicture;
using test::Gaussian;

constexpr int kWidth = 320;
constexpr int kHeight = 240;
constexpr Pinhole kPinhole{262, 262, 159.5, 119.5};
constexpr double kNoiseShare = 0.5;  // of σ_d
constexpr double kRange_m = 5;

struct Plane {
  Vector3 n;
  double d;  // n · X = d, X in the reference's coordinates
};
std::vector<Plane> corridor() {
  return {{{1, 0, 0}, 1.0}, {{1, 0, 0}, -0.9}, {{0, 1, 0}, 1.2}, {{0, 1, 0}, -1.1}};
}
std::vector<Plane> closed(std::vector<Plane> planes) {
  planes.push_back({{0, 0, 1}, 3.5});
  return planes;
}

DepthPicture picture(const std::vector<Plane>& planes, const Se3& T_camera_reference, Gaussian& gaussian) {
  return {kWidth, kHeight, [&](int x, int y) {
            double nearest = kRange_m;
            for (const Plane& plane : planes) {
              const Vector3 n = T_camera_reference.R * plane.n;
              const double z = test::depth_of_plane(kPinhole, x, y, n, plane.d + n.dot(T_camera_reference.t));
              if (z > 0 && z < nearest) nearest = z;
            }
            if (!(nearest < kRange_m)) return 0.0;
            return nearest + kNoiseShare * DepthNoise{}.sigma(nearest) * gaussian();
          }};
}

struct Pair {
  Pair(const std::vector<Plane>& planes, const Se3& motion, std::uint64_t seed)
      : truth(motion), memory(1 << 20), arena(memory), storage(200) {
    Gaussian gaussian(seed);
    features.allocate(arena, 200);
    const DepthPicture before = picture(planes, Se3{}, gaussian);
    const DepthPicture after = picture(planes, motion, gaussian);
    sample_surfaces(before.sampler(), kPinhole, kWidth, kHeight, kNoiseShare * kNoiseShare, arena, features);
    FixedVector<SurfaceMatch> found(storage);
    track_surfaces(after.sampler(), kPinhole, kNoiseShare * kNoiseShare, features.samples.span(), motion,
                   found);
    storage.resize(found.size());
    flags.resize(found.size());
  }
  SurfaceConstraints constraints() { return {storage, {flags, {&form, 1}}}; }
  JointInformation information() {
    SurfaceConstraints set = constraints();
    set.begin(truth, {}, RobustKernel(), 1);
    JointInformation sum;
    (void)set.linearize(truth, {}, RobustKernel(), sum);
    return sum;
  }

  Se3 truth;
  std::vector<std::byte> memory;
  Arena arena;
  SurfaceFeatures features;
  std::vector<SurfaceMatch> storage;
  std::vector<std::uint8_t> flags;
  SurfaceForm form;
};

Se3 motion() { return {rotation_exp({0.01, -0.03, 0.02}), {0.02, -0.01, -0.06}}; }

TEST(SurfaceTracking, FindsTheSurfacesAtTheTrueMotion) {
  Pair pair(closed(corridor()), motion(), 1);
  ASSERT_GT(pair.features.samples.size(), 60U);
  EXPECT_GT(pair.storage.size(), 0.7 * static_cast<double>(pair.features.samples.size()));
  const SurfaceConstraints set = pair.constraints();
  double sum = 0;
  for (std::size_t i = 0; i < set.size(); ++i) sum += set.mahalanobis_squared(i, pair.truth);
  const double mean = sum / static_cast<double>(set.size());
  // The modelled variance is that of one reading, in both frames. A plane through 49 readings has a 49th of
  // it, which the odometry learns. Tolerance: three standard deviations of the mean of the squares.
  EXPECT_NEAR(49 * mean, 1, 3 * std::sqrt(2.0 / static_cast<double>(set.size())));
}

TEST(SurfaceTracking, ARoomFixesTheMotionButACorridorLeavesItsAxisOpen) {
  double along_room = 0, along = 0, across = 0;
  constexpr int kPairs = 6;
  for (std::uint64_t seed = 1; seed <= kPairs; ++seed) {
    const Vector3 axis = motion().R.col(2);
    const Matrix3 room = Pair(closed(corridor()), motion(), seed).information().H.block<3, 3>(0, 0);
    const Matrix3 open = Pair(corridor(), motion(), seed).information().H.block<3, 3>(0, 0);
    along_room += axis.dot(room * axis) / kPairs;
    along += axis.dot(open * axis) / kPairs;
    across += motion().R.col(0).dot(open * motion().R.col(0)) / kPairs;
  }
  // 1/1e3 corresponds to 30 mm: the information along the corridor's axis must not claim more.
  EXPECT_LT(std::abs(along), 1e3);
  EXPECT_GT(across, 100 * std::abs(along));
  EXPECT_GT(along_room, 20 * std::abs(along));
}

TEST(SurfaceTracking, RejectsAnotherSurface) {
  Gaussian gaussian(3);
  const Se3 none;
  Pair pair(closed(corridor()), none, 3);
  // The end of the corridor moves half a metre closer; none of its samples may find a match.
  std::vector<Plane> nearer = corridor();
  nearer.push_back({{0, 0, 1}, 3.0});
  std::vector<SurfaceMatch> storage(200);
  FixedVector<SurfaceMatch> found(storage);
  track_surfaces(picture(nearer, none, gaussian).sampler(), kPinhole, 0.25, pair.features.samples.span(),
                 none, found);
  EXPECT_GT(found.size(), 20U);
  for (const SurfaceMatch& match : found) EXPECT_LT(std::abs(match.normal.z()), 0.5);
}

struct Tracked {
  std::vector<TrackResult> results;
  double error_m = 0;
};
Tracked track_with(int surfaces, bool used = true) {
  Limits limits = Limits::qvga();
  limits.surfaces = surfaces;
  ProceduralSequence sequence(kWidth, kHeight);
  std::vector<std::byte> memory(required_bytes(limits));
  Odometry odometry;
  Config config;
  config.surfaces = used;
  const Status status = odometry.init(memory, sequence.camera(), config, limits);
  EXPECT_TRUE(status.ok()) << status.message();
  Tracked tracked;
  for (int i = 0; i < 15; ++i) {
    tracked.results.push_back(odometry.track(i == 8 ? sequence.render_dark(i) : sequence.render(i)));
    const Se3 expected =
        ProceduralSequence::T_world_camera(0).inverse() * ProceduralSequence::T_world_camera(i);
    if (i != 8)
      tracked.error_m =
          std::max(tracked.error_m, (tracked.results.back().T_world_camera.t - expected.t).norm());
  }
  EXPECT_LE(odometry.memory_peak(), memory.size());
  return tracked;
}

TEST(SurfacesInTheOdometry, AreUsedIfLimitsAllowThem) {
  const Tracked with = track_with(200);
  const Tracked again = track_with(200);
  const Tracked without = track_with(0);
  const Tracked unused = track_with(200, false);
  EXPECT_LT(with.error_m, 0.02);
  for (std::size_t i = 0; i < with.results.size(); ++i) {
    EXPECT_EQ(with.results[i].state, without.results[i].state);
    EXPECT_EQ(with.results[i].T_world_camera.t, again.results[i].T_world_camera.t);
    EXPECT_EQ(with.results[i].motion_covariance, again.results[i].motion_covariance);
    EXPECT_EQ(without.results[i].T_world_camera.t, unused.results[i].T_world_camera.t);
    EXPECT_EQ(without.results[i].motion_covariance, unused.results[i].motion_covariance);
  }
  EXPECT_NE(with.results.back().T_world_camera.t, without.results.back().T_world_camera.t);
  EXPECT_LT(with.results.back().motion_covariance.trace(), without.results.back().motion_covariance.trace());
}

TEST(SurfacesInTheOdometry, TakeMemoryAsLimitsState) {
  Limits limits = Limits::vga();
  EXPECT_TRUE(limits.validate().ok());
  const std::size_t with = required_bytes(limits);
  limits.surfaces = 0;  // as in the smaller Limits
  EXPECT_EQ(limits.surfaces, Limits::qvga().surfaces);
  EXPECT_EQ(limits.surfaces, Limits::tiny().surfaces);
  EXPECT_TRUE(limits.validate().ok());
  EXPECT_LT(required_bytes(limits), with);
  EXPECT_GT(required_bytes(limits) + 300'000, with);
  limits.surfaces = 1001;
  EXPECT_FALSE(limits.validate().ok());
  limits.surfaces = -1;
  EXPECT_FALSE(limits.validate().ok());
}

}  // namespace
}  // namespace plvo
