// SPDX-License-Identifier: Apache-2.0
// A rolling shutter distorts a view by the velocity of the camera. What the map keeps is not distorted.
#include "plvo/map/map_keyframe.hpp"

#include <gtest/gtest.h>

#include <cstdio>
#include <vector>

#include "plvo/base/random.hpp"
#include "plvo/camera/exposure.hpp"
#include "plvo/map/loop_check.hpp"

namespace plvo {
namespace {

CameraModel camera_with(double readout_s) {
  CameraModel camera{320, 240, Pinhole{250, 250, 160, 120}, {}};
  camera.readout_s = readout_s;
  return camera;
}

// Points and lines before a camera. They are the same for the same seed.
struct Scene {
  static constexpr std::size_t kPoints = 150, kLines = 30;
  Scene() {
    Random random(3);
    const auto within = [&](double low, double high) { return low + (high - low) * random.uniform(); };
    for (std::size_t i = 0; i < kPoints; ++i) {
      const double z = within(1, 4);
      points.emplace_back(within(-0.5, 0.5) * z, within(-0.4, 0.4) * z, z);
      Descriptor descriptor;
      for (std::uint64_t& word : descriptor)
        word = static_cast<std::uint64_t>(random.next()) << 32 | random.next();
      descriptors.push_back(descriptor);
    }
    for (std::size_t i = 0; i < kLines; ++i) {
      const double z = within(1, 4);
      lines.push_back({Vector3(within(-0.4, 0) * z, within(-0.3, 0) * z, z),
                       Vector3(within(0, 0.4) * z, within(0, 0.3) * z, z)});
      LineDescriptor descriptor;
      for (std::uint8_t& entry : descriptor.value) entry = static_cast<std::uint8_t>(random.below(256));
      line_descriptors.push_back(descriptor);
    }
  }

  std::vector<Vector3> points;
  std::vector<std::array<Vector3, 2>> lines;
  std::vector<Descriptor> descriptors;
  std::vector<LineDescriptor> line_descriptors;
};

constexpr MapLimits kTwoViews{MapLimits::kLeastKeyframes, 200, 64};
constexpr std::size_t kOld = 0, kNew = 1;

// What the map keeps of two views.
class Kept {
 public:
  explicit Kept(double readout_s) : camera_(camera_with(readout_s)), memory_(1 << 20), arena_(memory_) {
    store_.allocate(arena_, kTwoViews);
    EXPECT_FALSE(arena_.exhausted());
  }

  // The view from T_scene_camera, which moves with this velocity when its middle row is exposed. The map is
  // told another one.
  void see(std::size_t slot, const Se3& T_scene_camera, const Vector6& velocity, const Vector6& told) {
    const Exposure exposure(camera_, velocity, 0);
    const auto seen = [&](const Vector3& p) { return exposure.as_seen(T_scene_camera.inverse() * p); };
    std::vector<Keypoint> keypoints(Scene::kPoints);
    std::vector<Point3d> points_3d(Scene::kPoints);
    std::vector<Line3d> lines_3d(Scene::kLines);
    for (std::size_t i = 0; i < keypoints.size(); ++i) {
      points_3d[i].p = seen(scene_.points[i]);
      points_3d[i].Sigma = kVariance_m2 * Matrix3::Identity();
      const Vector2 at = project(camera_.pinhole, points_3d[i].p);
      keypoints[i].u = static_cast<float>(at.x());
      keypoints[i].v = static_cast<float>(at.y());
    }
    for (std::size_t i = 0; i < lines_3d.size(); ++i) {
      lines_3d[i].a = seen(scene_.lines[i][0]);
      lines_3d[i].b = seen(scene_.lines[i][1]);
      lines_3d[i].Sigma = kVariance_m2 * Matrix6::Identity();
    }
    PointFeatures points;
    points.keypoints = FixedVector<Keypoint>(keypoints);
    points.keypoints.resize(keypoints.size());
    points.points = points_3d;
    points.descriptors = scene_.descriptors;
    LineFeatures lines;
    lines.lines = lines_3d;
    lines.count_3d = lines_3d.size();
    lines.descriptors = scene_.line_descriptors;
    store_.set(slot, points, lines, camera_, told);
  }

  MapFeatures at(std::size_t slot) const { return store_.at(slot); }
  const CameraModel& camera() const { return camera_; }
  const Scene& scene() const { return scene_; }
  LoopMeasurement compare() {
    Arena sizer = Arena::counting();
    LoopCheck::reserve(sizer, kTwoViews, camera_.width, camera_.height);
    std::vector<std::byte> memory(sizer.peak() + kArenaAlignment);
    Arena arena{memory};
    return LoopCheck(camera_, Config())(at(kOld), at(kNew), arena);
  }

 private:
  static constexpr double kVariance_m2 = 1e-4;

  CameraModel camera_;
  Scene scene_;
  std::vector<std::byte> memory_;
  Arena arena_;
  MapFeatureStore store_;
};

Vector6 turning(double rad_per_s) {
  Vector6 velocity;
  velocity << 0.3, 0, -0.5, 0, rad_per_s, 0;
  return velocity;
}

TEST(MapKeyframe, KeepsFeaturesWhereTheyAreWhenTheMiddleRowIsExposed) {
  Kept kept(kKinectReadout_s);
  kept.see(kOld, Se3(), turning(1), turning(1));
  const MapFeatures features = kept.at(kOld);
  ASSERT_EQ(features.points.size(), Scene::kPoints);
  ASSERT_EQ(features.lines.size(), Scene::kLines);
  for (std::size_t i = 0; i < Scene::kPoints; ++i) {
    const Vector3& p = kept.scene().points[i];
    const Vector2 at = project(kept.camera().pinhole, p);
    EXPECT_NEAR(static_cast<double>(features.points[i].u), at.x(), 0.01);
    EXPECT_NEAR(static_cast<double>(features.points[i].v), at.y(), 0.01);
    EXPECT_NEAR(static_cast<double>(features.points[i].depth_m), p.z(), 1e-4);
  }
  for (std::size_t i = 0; i < Scene::kLines; ++i) {
    const Line3d line = unpack(features.lines[i]);
    EXPECT_LT((line.a - kept.scene().lines[i][0]).norm(), 1e-4);
    EXPECT_LT((line.b - kept.scene().lines[i][1]).norm(), 1e-4);
  }
}

TEST(MapKeyframe, WithAGlobalShutterTheVelocityChangesNothing) {
  Kept kept(0);
  kept.see(kOld, Se3(), turning(1), turning(1));
  kept.see(kNew, Se3(), turning(1), Vector6::Zero());
  const MapFeatures a = kept.at(kOld), b = kept.at(kNew);
  ASSERT_EQ(a.points.size(), b.points.size());
  for (std::size_t i = 0; i < a.points.size(); ++i) {
    EXPECT_EQ(a.points[i].u, b.points[i].u);
    EXPECT_EQ(a.points[i].v, b.points[i].v);
    EXPECT_EQ(a.points[i].depth_m, b.points[i].depth_m);
  }
  ASSERT_EQ(a.lines.size(), b.lines.size());
  for (std::size_t i = 0; i < a.lines.size(); ++i) EXPECT_TRUE(a.lines[i].a == b.lines[i].a);
}

// A saved map is refused if a pixel lies outside of the image.
TEST(MapKeyframe, PointsThatLeaveTheImageStayAtItsBorder) {
  Kept kept(0.1);
  kept.see(kOld, Se3(), Vector6::Zero(), turning(10));
  const MapFeatures features = kept.at(kOld);
  ASSERT_EQ(features.points.size(), Scene::kPoints);
  std::size_t at_border = 0;
  const auto right = static_cast<float>(kept.camera().width - 1);
  for (const MapPoint& point : features.points) {
    EXPECT_TRUE(point.u >= 0 && point.u <= right && point.v >= 0 && point.v <= 239)
        << point.u << ' ' << point.v;
    at_border += point.u == 0 || point.u == right ? 1U : 0U;
  }
  EXPECT_GT(at_border, 0U);
}

TEST(MapKeyframe, ALoopIsExactWhateverTheVelocities) {
  const Se3 T_old_new{rotation_exp(Vector3(0.02, 0.05, 0)), Vector3(0.1, 0.02, 0.05)};
  const auto errors = [&](bool told) {
    Kept kept(kKinectReadout_s);
    kept.see(kOld, Se3(), turning(1.5), told ? turning(1.5) : Vector6::Zero());
    kept.see(kNew, T_old_new, turning(-1.5), told ? turning(-1.5) : Vector6::Zero());
    const LoopMeasurement loop = kept.compare();
    EXPECT_TRUE(loop.found);
    const double error_m = (loop.T_old_new.t - T_old_new.t).norm();
    std::printf("%s: %.2f mm, %d inliers\n", told ? "moved to mid-exposure" : "as seen", 1e3 * error_m,
                loop.inliers);
    return error_m;
  };
  EXPECT_GT(errors(false), 2e-3) << "the shutter must matter for the test to mean something";
  EXPECT_LT(errors(true), 1e-4);
}

}  // namespace
}  // namespace plvo
