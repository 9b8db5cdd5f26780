// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <string>
#include <vector>

#include "plvo/base/random.hpp"
#include "plvo/bench/map/evaluation.hpp"
#include "plvo/bench/map/posed_camera.hpp"
#include "plvo/bench/map/studies.hpp"
#include "plvo/host/files/trajectory_file.hpp"
#include "plvo/math/trigonometry.hpp"

namespace plvo::bench {
namespace {

constexpr int kFramesOfTheMap = 600;
constexpr int kFramesBefore = 10;  // of the sequence, before the camera is carried away
constexpr int kMostFrames = 30;    // in which the camera may find its place
constexpr int kFramesAfter = 30;   // in which a wrong place may become the right one
constexpr std::int64_t kFrame_ns = 33'333'333, kCarried_ns = 60'000'000'000;
// The camera then moves on beside the mapped trajectory, within these of it.
constexpr double kAside_m = 0.3, kHeight_m = 0.1, kYaw_rad = 10 * kPi / 180, kTilt_rad = 5 * kPi / 180;
constexpr int kTriesOfACarry = 50;  // to find a place where the camera can be
// The camera is found when the map states its position within this standard deviation.
constexpr double kKnown_m = 0.1;

bool is_found(const MapEvaluation& evaluation) {
  return evaluation.in_map.located && has_pose(evaluation.result) &&
         evaluation.in_map.pose_covariance.topLeftCorner<3, 3>().trace() < kKnown_m * kKnown_m;
}

class Trials {
 public:
  explicit Trials(const MapStudy& study)
      : camera_(simulated(study.scene, study.light, study.seed, study.width, kFramesOfTheMap)),
        evaluation_(camera_.model(), 256),
        random_(study.seed, 0x6361) {
    for (int k = 0; k < kFramesOfTheMap; ++k) {
      const double t_s = k * camera_.frame_s();
      const RgbdFrame frame =
          camera_.take([&](double s) { return camera_.trajectory(s); }, t_s, next_stamp());
      if (k < kFramesBefore) keep(frame);
      evaluation_.see(frame, camera_.trajectory(t_s));
    }
    file_ = evaluation_.save();
    keyframes_ = evaluation_.map.graph().size();
    wrong_in_map_ = evaluation_.wrong_loops();
    lost_ = evaluation_.lost();
  }

  // [frames until the camera was found (0: it was not), wrong loops, distance (m) and angle (rad) in the map
  // from the truth when it was found, frames with a wrong place from then on, distance at the end (m)].
  std::string at(double start_s, const Se3& T_trajectory_camera, bool in_the_dark) {
    evaluation_.load(file_);
    if (in_the_dark) {
      for (std::size_t k = 0; k < before_.size(); ++k) {
        RgbdFrame frame = before_[k];
        frame.colour.data = colours_[k].data();
        frame.depth.data = depths_[k].data();
        frame.stamp_ns = frame.depth_stamp_ns = next_stamp();
        evaluation_.see(frame, camera_.trajectory(static_cast<double>(k) * camera_.frame_s()));
      }
      evaluation_.settle();
      stamp_ns_ += kCarried_ns;
      evaluation_.see_nothing(next_stamp());
    }
    evaluation_.forget_loops();
    camera_.arrive();
    const PosedCamera::Motion motion = [&](double t_s) {
      return camera_.trajectory(t_s) * T_trajectory_camera;
    };
    int found = 0, wrong_frames = 0;
    PoseError first, last;
    for (int k = 0; found == 0 ? k < kMostFrames : last.wrong() && k < found + kFramesAfter; ++k) {
      const double t_s = start_s + k * camera_.frame_s();
      evaluation_.see(camera_.take(motion, t_s, next_stamp()), motion(t_s));
      if (!is_found(evaluation_)) continue;
      last = pose_error(evaluation_.in_map.T_map_world * evaluation_.result.T_world_camera,
                        camera_.trajectory(0).inverse() * motion(t_s));
      wrong_frames += last.wrong() ? 1 : 0;
      if (found != 0) continue;
      found = k + 1;
      first = last;
    }
    return fmt::format("[{}, {}, {:.4f}, {:.4f}, {}, {:.4f}]", found, evaluation_.wrong_loops(), first.m,
                       first.rad, wrong_frames, last.m);
  }

  // A pose beside the trajectory, and the time at which the trajectory is nearest.
  void draw(double& start_s, Se3& T_trajectory_camera) {
    const double last_s = camera_.duration_s() - (kMostFrames + kFramesAfter) * camera_.frame_s();
    const auto within = [&](double most) { return most * (2 * random_.uniform() - 1); };
    for (int i = 0; i < kTriesOfACarry; ++i) {
      start_s = last_s * random_.uniform();
      const Vector3 aside(within(kAside_m), within(kHeight_m), within(kAside_m));  // right, down, ahead
      const Vector3 turn(within(kTilt_rad), within(kYaw_rad), within(kTilt_rad));
      T_trajectory_camera = {rotation_exp(turn), aside};
      if (camera_.is_free(camera_.trajectory(start_s).t,
                          (camera_.trajectory(start_s) * T_trajectory_camera).t))
        return;
    }
    T_trajectory_camera = {};
  }

  std::string summary() const {
    return fmt::format("\"keyframes\": {}, \"wrong_in_map\": {}, \"lost\": {}", keyframes_, wrong_in_map_,
                       lost_);
  }

 private:
  std::int64_t next_stamp() { return stamp_ns_ += kFrame_ns; }
  void keep(const RgbdFrame& frame) {
    const std::ptrdiff_t pixels = std::ptrdiff_t{frame.colour.width} * frame.colour.height;
    before_.push_back(frame);
    colours_.emplace_back(frame.colour.data, frame.colour.data + 3 * pixels);
    depths_.emplace_back(frame.depth.data, frame.depth.data + pixels);
  }

  PosedCamera camera_;
  MapEvaluation evaluation_;
  Random random_;
  std::int64_t stamp_ns_ = 0;
  std::vector<std::byte> file_;
  std::vector<RgbdFrame> before_;
  std::vector<std::vector<std::uint8_t>> colours_;
  std::vector<std::vector<std::uint16_t>> depths_;
  std::size_t keyframes_ = 0;
  int wrong_in_map_ = 0, lost_ = 0;
};

}  // namespace

void carried(const MapStudy& study) {
  Trials trials(study);
  std::string dark, anew;
  for (int trial = 0; trial < study.amount; ++trial) {
    double start_s = 0;
    Se3 T_trajectory_camera;
    trials.draw(start_s, T_trajectory_camera);
    const char* between = trial == 0 ? "" : ", ";
    dark += between + trials.at(start_s, T_trajectory_camera, true);
    anew += between + trials.at(start_s, T_trajectory_camera, false);
  }
  fmt::print("{{{}, \"dark\": [{}], \"anew\": [{}]}}\n", trials.summary(), dark, anew);
}

}  // namespace plvo::bench
