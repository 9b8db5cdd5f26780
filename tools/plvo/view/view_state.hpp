// SPDX-License-Identifier: Apache-2.0
// The data for the viewers, passed from the odometry's thread to the threads that encode and send. The
// odometry copies into a spare snapshot and swaps it in: it never waits for a viewer, an encoder or a
// network.
#pragma once

#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "plvo/image/frame.hpp"
#include "plvo/odometry/odometry.hpp"

namespace plvo {

// State of the session beyond the result of the odometry.
struct ViewStatus {
  std::string camera = "waiting for the first frame";  // state of the camera in words
  bool silent = false;  // no frames arrive: all other values are those of the last frame
  double camera_hz = 0;
  double odometry_hz = 0;
  double latency_ms = 0;  // from the arrival of a frame to its pose
  std::uint64_t frames = 0;
  std::uint64_t lost = 0;
  std::uint64_t dropped = 0;
  // With a map.
  struct Map {
    bool located = false;
    int loops = 0;  // closed since the start
  };
  std::optional<Map> map;
};

// Processing state of a feature; the page chooses its colour by it.
enum class FeatureFate : std::uint8_t { kSeen, kWithDepth, kMatched, kInlier };

struct ViewSnapshot {
  struct Point {
    float u = 0, v = 0;                      // px
    float u_reference = 0, v_reference = 0;  // position in the reference, if matched
    FeatureFate fate = FeatureFate::kSeen;
  };
  struct Segment {
    float a_u = 0, a_v = 0, b_u = 0, b_v = 0;
    FeatureFate fate = FeatureFate::kSeen;
  };
  std::uint64_t image_sequence = 0;  // 0: no image yet
  int width = 0, height = 0;
  PixelFormat format = PixelFormat::kGray8;
  std::vector<std::uint8_t> pixels;  // without padding
  int depth_width = 0, depth_height = 0;
  double metres_per_unit = 0.001;
  std::vector<std::uint16_t> depth;
  std::vector<Point> points;
  std::vector<Segment> segments;

  // image: the camera's colours if the lens has no distortion, else the image in which features are detected.
  void copy_images(const RgbdFrame& frame, const FeatureView& features, bool lens_is_straight);
  void copy_features(const FeatureView& features);
};

// The path so far, thinned to keep within its capacity: when it is full, every second point is removed and
// the spacing doubles. epoch() then changes to tell a viewer that its copy is outdated.
class ViewPath {
 public:
  static constexpr std::size_t kCapacity = 8192;
  static constexpr double kSpacing_m = 0.005;

  ViewPath() { points_.reserve(kCapacity); }
  void add(const Vector3& position);
  std::uint64_t epoch() const { return epoch_; }
  const std::vector<Vector3>& points() const { return points_; }

 private:
  std::vector<Vector3> points_;
  double spacing_m_ = kSpacing_m;
  std::uint64_t epoch_ = 0;
};

// Paints depth in the colours of report/palette.hpp, every second pixel of every second row; black: no depth.
void paint_depth(const ViewSnapshot& snapshot, std::vector<std::uint8_t>& rgb, int& width, int& height);

}  // namespace plvo
