// SPDX-License-Identifier: Apache-2.0
// Evaluates line matching and 3D lines on a recorded sequence with ground truth. A match is right if the 3D
// line of the reference, moved by the true motion, projects within 3 px of both endpoints of the current
// segment and overlaps it. For right matches with a 3D line in both frames, the NEES tells whether the
// distance of the two lines agrees with their covariances.
//   line_match_precision DIR [--frames N] [--stride N] [--prediction none|previous|true] …
#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "plvo/base/arena.hpp"
#include "plvo/eval/trajectory.hpp"
#include "plvo/image/depth_sampler.hpp"
#include "plvo/image/gray.hpp"
#include "plvo/image/pyramid.hpp"
#include "plvo/image/undistortion.hpp"
#include "plvo/lines/line3d.hpp"
#include "plvo/lines/line_match.hpp"
#include "plvo/lines/lsd/lsd.hpp"
#include "plvo/lines/msld.hpp"
#include "plvo/odometry/config.hpp"
#include "plvo/replay/calibration/calibration.hpp"
#include "plvo/replay/recorded_camera.hpp"

namespace {

using plvo::Se3;
using plvo::Vector2;
using plvo::Vector3;

constexpr std::size_t kCapacity = 256;
constexpr double kRightPx = 3;

// The data that outlive a frame's images.
struct FrameLines {
  std::vector<plvo::Segment> segments;
  std::vector<plvo::LineDescriptor> descriptors;
  std::vector<plvo::Line3d> lines;
  std::vector<bool> has_line;
  Se3 T_world_camera;
  bool has_truth = false;
};

struct Settings {
  std::string folder, prediction = "none";
  int frames = 1000, stride = 1;
  plvo::Line3dConfig line;
  plvo::LineMatchConfig match;
};

class FrontEnd {
 public:
  explicit FrontEnd(const plvo::CameraModel& camera)
      : camera_(camera), detector_((camera.width + 1) / 2, (camera.height + 1) / 2), memory_(32u << 20) {
    arena_ = plvo::Arena(memory_);
    map_.allocate(arena_, camera.width, camera.height);
    map_.init(camera);
    raw_.resize(static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height));
    pyramid_.allocate(arena_, camera.width, camera.height);
    pyramid_.init(camera.width, camera.height);
  }

  FrameLines look(const plvo::RgbdFrame& frame, const plvo::Line3dConfig& config) {
    const plvo::ImageView<std::uint8_t> raw{raw_.data(), camera_.width, camera_.height, camera_.width};
    plvo::to_gray(frame.colour, map_.active() ? raw : pyramid_.base());
    if (map_.active()) map_.undistort(raw, pyramid_.base());
    pyramid_.build();
    std::vector<plvo::Segment> storage(kCapacity);
    plvo::FixedVector<plvo::Segment> segments{std::span<plvo::Segment>(storage)};
    const plvo::Status status = detector_.detect(pyramid_.level(1), 2, pyramid_.level(0), arena_, segments);
    if (!status.ok()) fmt::print(stderr, "{}\n", status.message());
    const plvo::DepthNoise noise;
    const plvo::DepthSampler depth(frame.depth, map_, noise);
    FrameLines result;
    for (const plvo::Segment& s : segments) {
      if (s.length_px() < 20) continue;
      plvo::Line3d line;
      const bool ok =
          plvo::observe_line(s, depth, camera_.pinhole, noise, config, plvo::Config().seed, line).outcome ==
          plvo::Line3dOutcome::kOk;
      result.segments.push_back(s);
      result.descriptors.push_back(plvo::describe_segment(pyramid_.level(1), 0.5, s));
      result.lines.push_back(line);
      result.has_line.push_back(ok);
    }
    return result;
  }
  plvo::Arena& arena() { return arena_; }

 private:
  plvo::CameraModel camera_;
  plvo::SegmentDetector detector_;
  std::vector<std::byte> memory_;
  plvo::Arena arena_;
  plvo::UndistortionMap map_;
  plvo::Pyramid pyramid_;
  std::vector<std::uint8_t> raw_;
};

bool project_line(const plvo::Pinhole& pinhole, const Se3& T_current_reference, const plvo::Line3d& line,
                  plvo::Segment& out) {
  const Vector3 a = T_current_reference * line.a, b = T_current_reference * line.b;
  if (a.z() < 0.1 || b.z() < 0.1) return false;
  out.a = plvo::project(pinhole, a);
  out.b = plvo::project(pinhole, b);
  return out.length_px() > 1;
}

bool same_edge(const plvo::Segment& truth, const plvo::Segment& seen) {
  const Vector2 n = truth.normal(), d = truth.direction();
  if (d.dot(seen.direction()) < 0.9) return false;
  if (std::abs((seen.a - truth.a).dot(n)) > kRightPx || std::abs((seen.b - truth.a).dot(n)) > kRightPx)
    return false;
  const double s = (seen.a - truth.a).dot(d), e = (seen.b - truth.a).dot(d);
  return std::min(e, truth.length_px()) - std::max(s, 0.0) > 0;
}

// Error of the current line's endpoints relative to the moved reference line: two offsets in depth (in the
// plane through the camera centre and the segment) and two across it, with their covariances.
struct Disagreement {
  double nees_depth = 0, nees_across = 0;  // 2 degrees of freedom each
  double depth_m = 0, across_m = 0;        // RMS of the two ends
};

bool disagree(const plvo::Line3d& current, const plvo::Line3d& reference, const Se3& T, Disagreement& out) {
  const Eigen::Vector3d a = T * reference.a, b = T * reference.b;
  const Eigen::Vector3d d = (b - a).normalized();
  const Eigen::Vector3d across = Eigen::Vector3d(current.a).cross(Eigen::Vector3d(current.b)).normalized();
  const Eigen::Vector3d deep = d.cross(across).normalized();
  Eigen::Matrix<double, 4, 6> J_c = Eigen::Matrix<double, 4, 6>::Zero(), J_r = J_c;
  Eigen::Vector4d e;
  for (int k = 0; k < 2; ++k) {
    const Eigen::Vector3d p = k == 0 ? current.a : current.b;
    const double lambda = (p - a).dot(d) / (b - a).norm();
    if (lambda < -0.2 || lambda > 1.2) return false;
    const Eigen::Vector3d q = a + lambda * (b - a);
    for (int i = 0; i < 2; ++i) {
      const Eigen::RowVector3d n = (i == 0 ? deep : across).transpose();
      e(2 * i + k) = n.dot(p - q);
      J_c.block<1, 3>(2 * i + k, 3 * k) = n;
      J_r.block<1, 3>(2 * i + k, 0) = -(1 - lambda) * n * Eigen::Matrix3d(T.R);
      J_r.block<1, 3>(2 * i + k, 3) = -lambda * n * Eigen::Matrix3d(T.R);
    }
  }
  const Eigen::Matrix4d C = J_c * current.Sigma * J_c.transpose() + J_r * reference.Sigma * J_r.transpose();
  const Eigen::Vector2d e_depth = e.head<2>(), e_across = e.tail<2>();
  out.nees_depth = e_depth.dot(C.topLeftCorner<2, 2>().inverse() * e_depth);
  out.nees_across = e_across.dot(C.bottomRightCorner<2, 2>().inverse() * e_across);
  out.depth_m = std::sqrt(0.5 * e_depth.squaredNorm());
  out.across_m = std::sqrt(0.5 * e_across.squaredNorm());
  return true;
}

double quantile(std::vector<double> v, double q) {
  if (v.empty()) return 0;
  std::sort(v.begin(), v.end());
  return v[static_cast<std::size_t>(q * static_cast<double>(v.size() - 1))];
}

struct Totals {
  int pairs = 0;
  double segments = 0, lines = 0, matches = 0, judged = 0, right = 0, findable = 0;
  std::vector<double> nees_depth, nees_across, depth_mm, across_mm;
};

void compare(const FrameLines& reference, const FrameLines& current, const Se3& T_prediction, bool predict,
             const plvo::Pinhole& pinhole, const Settings& settings, plvo::Arena& arena, Totals& totals) {
  const Se3 T = current.T_world_camera.inverse() * reference.T_world_camera;
  std::vector<plvo::Segment> predicted = reference.segments;
  if (predict)
    for (std::size_t i = 0; i < predicted.size(); ++i)
      if (reference.has_line[i]) (void)project_line(pinhole, T_prediction, reference.lines[i], predicted[i]);
  std::vector<plvo::Match> storage(kCapacity);
  plvo::FixedVector<plvo::Match> matches{std::span<plvo::Match>(storage)};
  plvo::match_lines(predicted, reference.descriptors, current.segments, current.descriptors, settings.match,
                    arena, matches);
  ++totals.pairs;
  totals.matches += static_cast<double>(matches.size());
  totals.segments += static_cast<double>(current.segments.size());
  for (const bool has : current.has_line) totals.lines += has ? 1 : 0;
  for (std::size_t i = 0; i < reference.segments.size(); ++i) {
    plvo::Segment truth;
    if (!reference.has_line[i] || !project_line(pinhole, T, reference.lines[i], truth)) continue;
    totals.findable += std::any_of(current.segments.begin(), current.segments.end(),
                                   [&](const plvo::Segment& s) { return same_edge(truth, s); })
                           ? 1
                           : 0;
  }
  for (const plvo::Match& m : matches) {
    plvo::Segment truth;
    if (!reference.has_line[m.reference] || !project_line(pinhole, T, reference.lines[m.reference], truth))
      continue;
    ++totals.judged;
    if (!same_edge(truth, current.segments[m.current])) continue;
    ++totals.right;
    Disagreement d;
    if (!current.has_line[m.current] ||
        !disagree(current.lines[m.current], reference.lines[m.reference], T, d))
      continue;
    totals.nees_depth.push_back(d.nees_depth);
    totals.nees_across.push_back(d.nees_across);
    totals.depth_mm.push_back(1000 * d.depth_m);
    totals.across_mm.push_back(1000 * d.across_m);
  }
}

void print(const Settings& settings, const Totals& t) {
  const auto mean = [](const std::vector<double>& v) {
    double sum = 0;
    for (double x : v) sum += x;
    return v.empty() ? 0 : sum / static_cast<double>(v.size());
  };
  fmt::print("{}  prediction {}  stride {}\n", settings.folder, settings.prediction, settings.stride);
  fmt::print("  pairs {}  segments/frame {:.1f}  3D lines/frame {:.1f}  matches/pair {:.1f}\n", t.pairs,
             t.segments / t.pairs, t.lines / t.pairs, t.matches / t.pairs);
  fmt::print("  judged/pair {:.1f}  precision {:.2f} %  recall {:.1f} % of {:.1f}\n", t.judged / t.pairs,
             100 * t.right / t.judged, 100 * t.right / t.findable, t.findable / t.pairs);
  // A chi-square variable with 2 degrees of freedom has mean 2, median 1.39 and 95 % quantile 5.99.
  fmt::print("  depth : NEES mean {:6.2f} median {:5.2f} 95 % {:6.2f} | median {:5.1f} mm 95 % {:6.1f} mm\n",
             mean(t.nees_depth), quantile(t.nees_depth, 0.5), quantile(t.nees_depth, 0.95),
             quantile(t.depth_mm, 0.5), quantile(t.depth_mm, 0.95));
  fmt::print("  across: NEES mean {:6.2f} median {:5.2f} 95 % {:6.2f} | median {:5.1f} mm 95 % {:6.1f} mm\n",
             mean(t.nees_across), quantile(t.nees_across, 0.5), quantile(t.nees_across, 0.95),
             quantile(t.across_mm, 0.5), quantile(t.across_mm, 0.95));
}

int run(const Settings& settings) {
  plvo::Calibration calibration;
  plvo::RecordedCamera camera;
  plvo::eval::Trajectory truth;
  plvo::eval::TrajectorySource source;
  source.path = settings.folder + "/groundtruth.txt";
  for (const plvo::Status& status :
       {plvo::read_calibration(settings.folder + "/calibration.txt", calibration),
        camera.open(settings.folder, calibration), plvo::eval::read_trajectory(source, truth)})
    if (!status.ok()) {
      fmt::print(stderr, "{}\n", status.message());
      return 1;
    }
  auto front_end = std::make_unique<FrontEnd>(camera.model());
  std::vector<FrameLines> frames;
  plvo::RgbdFrame image;
  while (static_cast<int>(frames.size()) < settings.frames && camera.next(image).ok()) {
    frames.push_back(front_end->look(image, settings.line));
    const auto pose = plvo::eval::sample(truth, {image.stamp_ns}, {});
    frames.back().has_truth = pose.valid[0];
    frames.back().T_world_camera = pose.poses[0];
  }
  Totals totals;
  const auto stride = static_cast<std::size_t>(settings.stride);
  for (std::size_t k = 2 * stride; k < frames.size(); ++k) {
    const FrameLines &before = frames[k - 2 * stride], &reference = frames[k - stride], &current = frames[k];
    if (!before.has_truth || !reference.has_truth || !current.has_truth) continue;
    Se3 prediction = current.T_world_camera.inverse() * reference.T_world_camera;
    if (settings.prediction == "previous")
      prediction = reference.T_world_camera.inverse() * before.T_world_camera;
    compare(reference, current, prediction, settings.prediction != "none", camera.model().pinhole, settings,
            front_end->arena(), totals);
  }
  if (totals.pairs == 0) return 1;
  print(settings, totals);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  Settings settings;
  std::map<std::string, double*> numbers = {{"--max-offset", &settings.match.max_offset_px},
                                            {"--max-angle", &settings.match.max_angle_rad},
                                            {"--min-overlap", &settings.match.min_overlap},
                                            {"--max-ratio", &settings.match.max_ratio},
                                            {"--sigma-p", &settings.line.sigma_p_px},
                                            {"--inlier", &settings.line.inlier_chi_square},
                                            {"--tau", &settings.line.min_consensus},
                                            {"--depth-correlation", &settings.line.depth_correlation_px},
                                            {"--transverse-floor", &settings.line.transverse_floor_px}};
  std::map<std::string, int*> integers = {{"--frames", &settings.frames},
                                          {"--stride", &settings.stride},
                                          {"--side-reach", &settings.line.side_reach_px},
                                          {"--max-distance", &settings.match.max_distance}};
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (i + 1 < argc && numbers.contains(argument))
      *numbers[argument] = std::atof(argv[++i]);
    else if (i + 1 < argc && integers.contains(argument))
      *integers[argument] = std::atoi(argv[++i]);
    else if (i + 1 < argc && argument == "--prediction")
      settings.prediction = argv[++i];
    else
      settings.folder = argument;
  }
  if (settings.folder.empty()) {
    fmt::print(
        stderr,
        "usage: line_match_precision DIR [--frames N] [--stride N] [--prediction none|previous|true]\n");
    for (const auto& [name, value] : numbers) fmt::print(stderr, "  {} {}\n", name, *value);
    for (const auto& [name, value] : integers) fmt::print(stderr, "  {} {}\n", name, *value);
    return 2;
  }
  return run(settings);
}
