// SPDX-License-Identifier: Apache-2.0
#include "plvo/view/view_state.hpp"

#include <algorithm>
#include <cstring>

#include "plvo/report/palette.hpp"

namespace plvo {
namespace {

void copy_rows(const std::uint8_t* from, std::ptrdiff_t stride, std::size_t row_bytes, int rows,
               std::vector<std::uint8_t>& to) {
  to.resize(row_bytes * static_cast<std::size_t>(rows));
  for (int y = 0; y < rows; ++y) {
    std::memcpy(to.data() + static_cast<std::size_t>(y) * row_bytes, from + y * stride, row_bytes);
  }
}

}  // namespace

void ViewSnapshot::copy_images(const RgbdFrame& frame, const FeatureView& features, bool lens_is_straight) {
  if (lens_is_straight && frame.colour.data != nullptr) {
    width = frame.colour.width;
    height = frame.colour.height;
    format = frame.colour.format;
    const std::size_t bytes = static_cast<std::size_t>(width) * (format == PixelFormat::kGray8 ? 1 : 3);
    copy_rows(frame.colour.data, frame.colour.stride_bytes, bytes, height, pixels);
  } else if (features.image.data != nullptr) {
    width = features.image.width;
    height = features.image.height;
    format = PixelFormat::kGray8;
    copy_rows(features.image.data, features.image.stride, static_cast<std::size_t>(width), height, pixels);
  }
  if (frame.depth.data == nullptr) return;
  depth_width = frame.depth.width;
  depth_height = frame.depth.height;
  metres_per_unit = frame.depth.metres_per_unit;
  const auto row = static_cast<std::size_t>(depth_width);
  depth.resize(row * static_cast<std::size_t>(depth_height));
  for (int y = 0; y < depth_height; ++y) {
    std::memcpy(depth.data() + static_cast<std::size_t>(y) * row, frame.depth.data + y * frame.depth.stride,
                row * sizeof(std::uint16_t));
  }
}

void ViewSnapshot::copy_features(const FeatureView& features) {
  points.clear();
  for (const Keypoint& k : features.keypoints) points.push_back({k.u, k.v, k.u, k.v, FeatureFate::kSeen});
  for (const PointTrackView& t : features.point_tracks) {
    points.push_back(
        {t.u, t.v, t.u_reference, t.v_reference, t.inlier ? FeatureFate::kInlier : FeatureFate::kMatched});
  }
  segments.clear();
  for (const SegmentView& s : features.segments) {
    segments.push_back({s.a_u, s.a_v, s.b_u, s.b_v, s.has_3d ? FeatureFate::kWithDepth : FeatureFate::kSeen});
  }
  for (const LineTrackView& t : features.line_tracks) {
    if (t.current >= segments.size()) continue;
    FeatureFate& fate = segments[t.current].fate;
    fate = std::max(fate, t.inlier ? FeatureFate::kInlier : FeatureFate::kMatched);
  }
}

void ViewPath::add(const Vector3& position) {
  if (!points_.empty() && (position - points_.back()).norm() < spacing_m_) return;
  if (points_.size() == kCapacity) {
    for (std::size_t i = 0; 2 * i < kCapacity; ++i) points_[i] = points_[2 * i];
    points_.resize(kCapacity / 2);
    spacing_m_ *= 2;
    ++epoch_;
  }
  points_.push_back(position);
}

void paint_depth(const ViewSnapshot& snapshot, std::vector<std::uint8_t>& rgb, int& width, int& height) {
  width = snapshot.depth_width / 2;
  height = snapshot.depth_height / 2;
  rgb.assign(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 3, 0);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const std::uint16_t raw =
          snapshot.depth[static_cast<std::size_t>(2 * y) * static_cast<std::size_t>(snapshot.depth_width) +
                         static_cast<std::size_t>(2 * x)];
      if (raw == 0) continue;
      const report::Colour colour = report::depth_colour(raw * snapshot.metres_per_unit);
      std::uint8_t* pixel = rgb.data() + 3 * (static_cast<std::ptrdiff_t>(y) * width + x);
      pixel[0] = colour.r;
      pixel[1] = colour.g;
      pixel[2] = colour.b;
    }
  }
}

}  // namespace plvo
