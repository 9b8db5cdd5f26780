// SPDX-License-Identifier: Apache-2.0
#include "plvo/calibrate/tracked_recording.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <optional>

#include "plvo/odometry/odometry.hpp"

namespace plvo::calibrate {
namespace {

constexpr double kLongestGap_s = 0.2;

std::vector<std::uint16_t> copy_of(const DepthView& depth) {
  std::vector<std::uint16_t> pixels;
  pixels.reserve(static_cast<std::size_t>(depth.width) * static_cast<std::size_t>(depth.height));
  for (int y = 0; y < depth.height; ++y) {
    const std::uint16_t* row = depth.data + y * depth.stride;
    pixels.insert(pixels.end(), row, row + depth.width);
  }
  return pixels;
}

std::optional<std::size_t> frame_at(const std::vector<TrackedFrame>& frames, std::int64_t stamp_ns) {
  for (std::size_t i = frames.size(); i > 0; --i)
    if (frames[i - 1].stamp_ns == stamp_ns) return i - 1;
  return {};
}

void add_pair(const TrackResult& result, const FeatureView& view, TrackedRecording& recording) {
  const std::optional<std::size_t> reference = frame_at(recording.frames, result.reference_stamp_ns);
  if (!reference) return;
  FramePair pair{*reference, recording.frames.size(), {}, {}};
  for (const PointTrackView& track : view.point_tracks)
    pair.points.push_back(
        {Vector2(static_cast<double>(track.u_reference), static_cast<double>(track.v_reference)),
         Vector2(static_cast<double>(track.u), static_cast<double>(track.v))});
  for (const LineTrackView& track : view.line_tracks) pair.lines.push_back({track.reference, track.current});
  recording.pairs.push_back(std::move(pair));
}

TrackedFrame keep(const RgbdFrame& frame, const TrackResult& result, const FeatureView& view, int stretch) {
  TrackedFrame kept;
  kept.stamp_ns = frame.stamp_ns;
  kept.depth_stamp_ns = frame.depth_stamp_ns;
  kept.depth = copy_of(frame.depth);
  kept.T_world_camera = result.T_world_camera;
  kept.stretch = result.state == TrackState::kLost ? -1 : stretch;
  for (const SegmentView& segment : view.segments) {
    Segment copy;
    copy.a = {static_cast<double>(segment.a_u), static_cast<double>(segment.a_v)};
    copy.b = {static_cast<double>(segment.b_u), static_cast<double>(segment.b_v)};
    kept.segments.push_back(copy);
  }
  return kept;
}

// Computes the derivative at frame k of the polynomial through it and the given neighbours, on both sides if
// possible: the mean over the past alone would lag behind an oscillating hand. Returns false if a neighbour
// is missing.
bool find_velocity(const std::vector<TrackedFrame>& frames, std::size_t k,
                   std::initializer_list<int> neighbours, Vector6& velocity) {
  const TrackedFrame& here = frames[k];
  std::vector<double> seconds;
  std::vector<Vector6> moved;
  for (const int offset : neighbours) {
    const std::size_t i =
        k + static_cast<std::size_t>(offset);  // a negative index wraps around and is out of range
    if (here.stretch < 0 || i >= frames.size() || frames[i].stretch != here.stretch) return false;
    seconds.push_back(static_cast<double>(frames[i].stamp_ns - here.stamp_ns) * 1e-9);
    moved.push_back(boxminus(frames[i].T_world_camera.inverse() * here.T_world_camera, Se3{}));
    if (std::abs(seconds.back()) > kLongestGap_s * std::abs(offset)) return false;
  }
  velocity.setZero();
  for (std::size_t j = 0; j < seconds.size(); ++j) {
    double weight = 1 / seconds[j];
    for (std::size_t i = 0; i < seconds.size(); ++i)
      if (i != j) weight *= -seconds[i] / (seconds[j] - seconds[i]);
    velocity += weight * moved[j];
  }
  return true;
}

void find_velocities(TrackedRecording& recording) {
  for (std::size_t k = 0; k < recording.frames.size(); ++k) {
    TrackedFrame& frame = recording.frames[k];
    for (const std::initializer_list<int> neighbours :
         {std::initializer_list<int>{-2, -1, 1, 2}, {-1, 1}, {1, 2}, {-1, -2}})
      if (!frame.velocity_known)
        frame.velocity_known = find_velocity(recording.frames, k, neighbours, frame.velocity);
  }
  const auto unknown = [&](const FramePair& pair) {
    return !recording.frames[pair.reference].velocity_known || !recording.frames[pair.current].velocity_known;
  };
  recording.pairs.erase(std::remove_if(recording.pairs.begin(), recording.pairs.end(), unknown),
                        recording.pairs.end());
}

}  // namespace

Status track_recording(RgbdCamera& source, const CameraModel& camera, std::size_t most_frames,
                       const std::function<void()>& on_frame, TrackedRecording& recording) {
  recording = {};
  recording.camera = camera;
  Config config;
  config.references.policy = ReferencePolicy::kKeyframe;
  Limits limits;
  limits.width = camera.width;
  limits.height = camera.height;
  limits.kept_keyframes = 0;  // the correction of a pose would look like a velocity
  std::vector<std::byte> memory(required_bytes(limits) + kArenaAlignment);
  Odometry odometry;
  if (Status status = odometry.init(memory, camera, config, limits); !status.ok()) return status;
  int stretch = 0;
  while (recording.frames.size() < most_frames) {
    on_frame();
    RgbdFrame frame;
    const Status status = source.next(frame);
    if (status.code() == StatusCode::kDamaged || status.code() == StatusCode::kTimeout) continue;
    if (status.code() == StatusCode::kEndOfStream) break;
    if (!status.ok()) return status;
    recording.metres_per_unit = frame.depth.metres_per_unit;
    const TrackResult result = odometry.track(frame);
    // After a loss tracking restarts at the last good pose: the motion in between is unobserved.
    if (result.state == TrackState::kInitialising) ++stretch;
    const FeatureView view = odometry.features();
    if (result.state == TrackState::kTracking) add_pair(result, view, recording);
    recording.frames.push_back(keep(frame, result, view, stretch));
  }
  find_velocities(recording);
  return {};
}

}  // namespace plvo::calibrate
