// SPDX-License-Identifier: Apache-2.0
#include "plvo/calibrate/agreement.hpp"

#include <algorithm>
#include <array>
#include <thread>

#include "plvo/camera/exposure.hpp"
#include "plvo/image/depth_sampler.hpp"
#include "plvo/lines/line3d.hpp"
#include "plvo/motion/motion_estimator.hpp"
#include "plvo/odometry/config.hpp"

namespace plvo::calibrate {
namespace {

// Typical residuals of real and simulated sensors (docs/theory/noise.md); they only weigh image against
// depth.
constexpr double kReference_px = 0.05, kCurrent_px = 0.15;
constexpr double kShareOfSigma = 0.5;
// Mahalanobis distances above which a match is an outlier: the tail of χ²(3) and χ²(4) beyond is about 1e-6.
constexpr double kFarthestPoint = 30, kFarthestLine = 36;

struct Features {
  std::vector<Point3d> points;
  std::vector<Line3d> lines;
};

// Lifts the features of one frame to 3D with a candidate timing.
class Observer {
 public:
  Observer(const TrackedRecording& recording, const TrackedFrame& frame, const CameraModel& camera,
           const UndistortionMap& map)
      : camera_(camera),
        exposure_(
            camera, frame.velocity,
            static_cast<double>(frame.depth_stamp_ns - frame.stamp_ns) * 1e-9 + camera.depth_timing.delay_s),
        depth_({frame.depth.data(), camera.width, camera.height, camera.width, recording.metres_per_unit},
               map, config().depth_noise, exposure_) {}

  bool point(const Vector2& pixel, double sigma_px, Point3d& point) const {
    const DepthSample depth = depth_.sample(pixel.x(), pixel.y(), config().points.depth_reach_px);
    if (!(depth.depth_m > 0)) return false;
    point = observe_point(camera_.pinhole, pixel.x(), pixel.y(), depth.depth_m, sigma_px,
                          kShareOfSigma * depth.sigma_m);
    point.p = exposure_.at_mid_exposure(point.p);
    return true;
  }
  bool line(const Segment& segment, Line3d& line) const {
    if (observe_line(segment, depth_, camera_.pinhole, config().depth_noise, config().lines, config().seed,
                     line)
            .outcome != Line3dOutcome::kOk)
      return false;
    line.a = exposure_.at_mid_exposure(line.a);
    line.b = exposure_.at_mid_exposure(line.b);
    return true;
  }

 private:
  static const Config& config() {
    static const Config defaults;
    return defaults;
  }

  const CameraModel& camera_;
  Exposure exposure_;
  DepthSampler depth_;
};

std::vector<Match> identity_matches(std::size_t count) {
  std::vector<Match> matches;
  for (std::size_t i = 0; i < count; ++i)
    matches.push_back({static_cast<std::uint16_t>(i), static_cast<std::uint16_t>(i)});
  return matches;
}

// Sums over all `asked` matches: a match that could not be lifted or is not usable counts as an outlier.
double truncated_sum(const ConstraintSet& set, std::size_t asked, const Se3& T, double farthest) {
  double sum = 0;
  std::size_t used = 0;
  for (std::size_t i = 0; i < set.size(); ++i) {
    if (!set.usable(i)) continue;
    sum += std::min(farthest, set.mahalanobis_squared(i, T, farthest));
    ++used;
  }
  return sum + farthest * static_cast<double>(asked - used);
}

// Computes the cost of a pair of frames; each thread has its own.
class PairJudge {
 public:
  explicit PairJudge(std::size_t most_matches) {
    Arena sizer = Arena::counting();
    size_motion(sizer, 1, most_matches, most_matches);
    memory_.resize(sizer.peak() + kArenaAlignment);
    scratch_ = Arena(memory_);
  }

  double operator()(const TrackedRecording& recording, const FramePair& pair, const CameraModel& camera,
                    const UndistortionMap& map) {
    const TrackedFrame& reference_frame = recording.frames[pair.reference];
    const TrackedFrame& current_frame = recording.frames[pair.current];
    const Observer reference(recording, reference_frame, camera, map);
    const Observer current(recording, current_frame, camera, map);
    Features from, to;
    lift(pair, reference_frame, current_frame, reference, current, from, to);

    const ScratchScope scope(scratch_);
    const std::vector<Match> point_matches = identity_matches(from.points.size());
    const std::vector<Match> line_matches = identity_matches(from.lines.size());
    PointConstraints points(from.points, to.points, point_matches,
                            PointConstraints::Workspace::take(scratch_, point_matches.size()));
    LineConstraints lines(from.lines, to.lines, line_matches,
                          LineConstraints::Workspace::take(scratch_, line_matches.size()));
    const std::array<ConstraintSet*, 2> sets{&points, &lines};
    const Se3 T_predicted = current_frame.T_world_camera.inverse() * reference_frame.T_world_camera;
    constexpr LmOptions kSolve{.max_iterations = 20, .step_tolerance = 1e-6, .decrease_tolerance = 1e-9};
    const MotionEstimate motion =
        estimate_motion(sets, {}, MotionReferences{}, MotionConfig{}, kSolve, 1, &T_predicted, scratch_);
    if (motion.status != StatusCode::kOk)
      return kFarthestPoint * static_cast<double>(pair.points.size()) +
             kFarthestLine * static_cast<double>(pair.lines.size());
    return truncated_sum(points, pair.points.size(), motion.T_current_reference, kFarthestPoint) +
           truncated_sum(lines, pair.lines.size(), motion.T_current_reference, kFarthestLine);
  }

 private:
  static void lift(const FramePair& pair, const TrackedFrame& reference_frame,
                   const TrackedFrame& current_frame, const Observer& reference, const Observer& current,
                   Features& from, Features& to) {
    Point3d point_from, point_to;
    for (const PointPair& point : pair.points) {
      if (!reference.point(point.reference, kReference_px, point_from) ||
          !current.point(point.current, kCurrent_px, point_to))
        continue;
      from.points.push_back(point_from);
      to.points.push_back(point_to);
    }
    Line3d line_from, line_to;
    for (const Match& line : pair.lines) {
      if (!reference.line(reference_frame.segments[line.reference], line_from) ||
          !current.line(current_frame.segments[line.current], line_to))
        continue;
      from.lines.push_back(line_from);
      to.lines.push_back(line_to);
    }
  }

  std::vector<std::byte> memory_;
  Arena scratch_;
};

struct Job {
  const TrackedRecording* recording;
  const FramePair* pair;
  const CameraModel* camera;
  const UndistortionMap* map;
};

}  // namespace

SensorTiming timing_of(const CameraModel& camera) {
  return {camera.depth_timing.delay_s, camera.depth_timing.readout_s, camera.readout_s};
}

CameraModel with_timing(const CameraModel& camera, const SensorTiming& timing) {
  CameraModel result = camera;
  result.readout_s = timing.readout_s;
  result.depth_timing = {.known = true, .delay_s = timing.depth_delay_s, .readout_s = timing.depth_readout_s};
  return result;
}

std::vector<double> disagreement(std::span<const TrackedRecording> recordings, const SensorTiming& timing,
                                 std::size_t step, int threads) {
  std::vector<Job> jobs;
  std::vector<CameraModel> cameras;
  std::vector<UndistortionMap> maps(recordings.size());
  std::vector<std::vector<std::byte>> blocks;
  cameras.reserve(recordings.size());
  std::size_t most = 0, number = 0;
  for (std::size_t r = 0; r < recordings.size(); ++r) {
    const TrackedRecording& recording = recordings[r];
    cameras.push_back(with_timing(recording.camera, timing));
    Arena sizer = Arena::counting();
    UndistortionMap().allocate(sizer, recording.camera.width, recording.camera.height);
    blocks.emplace_back(sizer.peak() + kArenaAlignment);
    Arena arena(blocks.back());
    maps[r].allocate(arena, recording.camera.width, recording.camera.height);
    maps[r].init(recording.camera);
    for (const FramePair& pair : recording.pairs) {
      most = std::max({most, pair.points.size(), pair.lines.size()});
      if (number++ % step == 0) jobs.push_back({&recording, &pair, &cameras[r], &maps[r]});
    }
  }
  std::vector<double> sums(jobs.size());
  const auto work = [&](std::size_t first) {
    PairJudge judge(most);
    for (std::size_t i = first; i < jobs.size(); i += static_cast<std::size_t>(threads))
      sums[i] = judge(*jobs[i].recording, *jobs[i].pair, *jobs[i].camera, *jobs[i].map);
  };
  std::vector<std::thread> others;
  for (int t = 1; t < threads; ++t) others.emplace_back(work, static_cast<std::size_t>(t));
  work(0);
  for (std::thread& other : others) other.join();
  return sums;
}

}  // namespace plvo::calibrate
