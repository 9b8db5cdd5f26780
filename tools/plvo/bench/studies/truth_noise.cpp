// SPDX-License-Identifier: Apache-2.0
// Estimates the noise of a recording's ground truth from estimates with mutually independent errors.
// docs/decisions/truth_noise.md shows the results.
//   truth_noise GROUNDTRUTH TRAJECTORY TRAJECTORY…
// for every pair of trajectories, from frame to frame;
//   truth_noise --returns SEQUENCE CAMERA_MODEL [TRAJECTORY]
// for points and for lines, at frames in which the camera returns to an earlier view; the truth is fitted to
// the trajectory if one is given. Both print a Markdown table on standard output.
#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "plvo/eval/relative_error.hpp"
#include "plvo/eval/truth_fit.hpp"
#include "plvo/eval/truth_noise.hpp"
#include "plvo/math/trigonometry.hpp"
#include "plvo/odometry/odometry.hpp"
#include "plvo/replay/recorded_camera.hpp"

namespace plvo::bench {
namespace {

constexpr double kDegree = kPi / 180;
// Conditions of a return: the time difference exceeds the correlation time of the truth's fast noise, the
// view is almost the same, and neither frame is blurred.
constexpr std::int64_t kLeastApart_ns = 700'000'000;
constexpr double kMostTurn_deg = 10, kMostMove_m = 0.12;
constexpr double kMostTurn_deg_per_s = 30;
constexpr std::int64_t kAround_ns =
    50'000'000;  // half of the interval over which the angular rate is measured
constexpr std::size_t kMostReturns = 200;
// Estimates that differ by more are outliers, not noise.
constexpr double kMostDifference_deg = 1, kMostDifference_m = 0.05;

using Pair = std::pair<std::size_t, std::size_t>;

int fail(const std::string& why) {
  fmt::print(stderr, "truth_noise: {}\n", why);
  return 1;
}

std::string cells(const eval::TruthNoise& noise) {
  return fmt::format("{:.2f}, {:.3f} | {:.2f}, {:.3f} | {:.2f} mm, {:.3f} deg |", 1e3 * noise.first_m,
                     noise.first_rad / kDegree, 1e3 * noise.second_m, noise.second_rad / kDegree,
                     1e3 * noise.sigma.position_m, noise.sigma.orientation_rad / kDegree);
}

int study_frames(const std::vector<std::string>& files) {
  std::vector<eval::Trajectory> trajectories(files.size());
  for (std::size_t i = 0; i < files.size(); ++i)
    if (const Status status = read_trajectory({files[i], {}, {}}, trajectories[i]); !status.ok())
      return fail(std::string(status.message()));
  fmt::print(
      "| first | second | motions | RMSE of the first: mm, deg | of the second | the truth's, a pose and "
      "axis |\n"
      "|---|---|---:|---:|---:|---:|\n");
  for (std::size_t a = 1; a < files.size(); ++a) {
    for (std::size_t b = a + 1; b < files.size(); ++b) {
      const eval::TruthNoise noise = eval::truth_noise(trajectories[0], trajectories[a], trajectories[b], {});
      if (noise.motions == 0)
        return fail(files[a] + " and " + files[b] + " have no motion with ground truth in common");
      const auto name = [&](std::size_t i) { return std::filesystem::path(files[i]).stem().string(); };
      fmt::print("| {} | {} | {} | {}\n", name(a), name(b), noise.motions, cells(noise));
    }
  }
  return 0;
}

// Pairs each frame that has truth and a low angular rate with the frames that return to its view.
std::vector<Pair> find_returns(const eval::Trajectory& ground_truth, const std::vector<std::int64_t>& stamps,
                               const eval::SampledPoses& truth) {
  const auto at = [&](std::int64_t shift_ns) {
    std::vector<std::int64_t> shifted = stamps;
    for (std::int64_t& stamp : shifted) stamp += shift_ns;
    return eval::sample(ground_truth, shifted, {});
  };
  const eval::SampledPoses before = at(-kAround_ns), after = at(kAround_ns);
  std::vector<std::size_t> slow;
  for (std::size_t i = 0; i < stamps.size(); ++i) {
    if (!truth.valid[i] || !before.valid[i] || !after.valid[i]) continue;
    const double turn_deg = eval::rotation_angle_deg(before.poses[i].R.transpose() * after.poses[i].R);
    if (turn_deg < kMostTurn_deg_per_s * 2e-9 * static_cast<double>(kAround_ns)) slow.push_back(i);
  }
  std::vector<Pair> returns;
  for (const std::size_t i : slow) {
    for (const std::size_t j : slow) {
      if (stamps[j] - stamps[i] < kLeastApart_ns) continue;
      const Se3 motion = truth.poses[i].inverse() * truth.poses[j];
      if (eval::rotation_angle_deg(motion.R) < kMostTurn_deg && motion.t.norm() < kMostMove_m)
        returns.emplace_back(i, j);
    }
  }
  return returns;
}

std::vector<Pair> spread(const std::vector<Pair>& all) {
  const std::size_t count = std::min(all.size(), kMostReturns);
  std::vector<Pair> chosen;
  for (std::size_t k = 0; k < count; ++k) chosen.push_back(all[k * all.size() / count]);
  return chosen;
}

// Registers the second of two frames relative to the first with one kind of features.
class Registration {
 public:
  Status init(const CameraModel& camera, Features features) {
    Config config;
    config.features = features;
    config.surfaces = false;
    Limits limits;
    limits.width = camera.width;
    limits.height = camera.height;
    limits.surfaces = 0;
    memory_.resize(required_bytes(limits) + kArenaAlignment);
    return odometry_.init(memory_, camera, config, limits);
  }
  bool find(const RgbdFrame& first, const RgbdFrame& second, Se3& T_second_first) {
    odometry_.reset();
    (void)odometry_.track(first);
    const TrackResult result = odometry_.track(second);
    T_second_first = result.T_camera_reference;
    return result.state == TrackState::kTracking;
  }

 private:
  std::vector<std::byte> memory_;
  Odometry odometry_;
};

struct Recorded {
  std::filesystem::path folder;
  Calibration calibration;
  Status frame(std::size_t number, RecordedCamera& camera, RgbdFrame& frame) const {
    SequenceOptions one;
    one.first_frame = number;
    one.end_frame = number + 1;
    const Status status = camera.open(folder, calibration, one);
    return status.ok() ? camera.next(frame) : status;
  }
};

struct Returns {
  eval::CommonErrors errors;
  std::size_t lost = 0, different = 0;
};

Status measure(const Recorded& recorded, const CameraModel& camera, const std::vector<Pair>& pairs,
               const eval::SampledPoses& truth, Returns& returns) {
  Registration points, lines;
  Status status = points.init(camera, Features::kPoints);
  if (status.ok()) status = lines.init(camera, Features::kLines);
  RecordedCamera cameras[2];
  RgbdFrame first, second;
  for (const auto& [i, j] : pairs) {
    if (status.ok()) status = recorded.frame(i, cameras[0], first);
    if (status.ok()) status = recorded.frame(j, cameras[1], second);
    if (!status.ok()) return status;
    Se3 by_points, by_lines;
    if (!points.find(first, second, by_points) || !lines.find(first, second, by_lines)) {
      ++returns.lost;
      continue;
    }
    if ((by_points.t - by_lines.t).norm() > kMostDifference_m ||
        eval::rotation_angle_deg(by_points.R.transpose() * by_lines.R) > kMostDifference_deg) {
      ++returns.different;
      continue;
    }
    const Se3 motion = truth.poses[j].inverse() * truth.poses[i];
    returns.errors.add(boxminus(by_points, motion), boxminus(by_lines, motion));
  }
  return status;
}

// Corrects the constant errors of the ground truth.
Status fit_to(const std::string& file, eval::Trajectory& ground_truth) {
  eval::Trajectory estimate;
  eval::TruthFit fit;
  Status status = read_trajectory({file, {}, {}}, estimate);
  if (status.ok()) status = fit_truth(ground_truth, estimate, 0, fit);
  if (status.ok()) ground_truth = corrected(ground_truth, fit);
  return status;
}

int study_returns(const std::string& sequence, const std::string& camera_model,
                  const std::string& fitted_to) {
  Recorded recorded{sequence, {}};
  RecordedCamera camera;
  eval::Trajectory ground_truth;
  Status status = named_calibration(camera_model, recorded.calibration);
  if (status.ok()) status = camera.open(recorded.folder, recorded.calibration);
  if (status.ok()) status = read_ground_truth(recorded.folder, {}, ground_truth);
  if (status.ok() && !fitted_to.empty()) status = fit_to(fitted_to, ground_truth);
  if (!status.ok()) return fail(std::string(status.message()));
  std::vector<std::int64_t> stamps;
  for (const ImagePair& pair : camera.index().pairs) stamps.push_back(pair.colour.stamp_ns);
  const eval::SampledPoses truth = eval::sample(ground_truth, stamps, {});
  const std::vector<Pair> pairs = spread(find_returns(ground_truth, stamps, truth));
  Returns returns;
  status = measure(recorded, camera.model(), pairs, truth, returns);
  if (!status.ok()) return fail(std::string(status.message()));
  const eval::TruthNoise noise = returns.errors.noise();
  if (noise.motions == 0)
    return fail(fmt::format("{}: of {} returns {} were lost and {} estimates differ; none is left", sequence,
                            pairs.size(), returns.lost, returns.different));
  fmt::print(
      "| sequence | returns | lost | points and lines differ | motions left | RMSE of points: mm, deg | of "
      "lines | the truth's, a pose and axis |\n"
      "|---|---:|---:|---:|---:|---:|---:|---:|\n");
  fmt::print("| {} | {} | {} | {} | {} | {}\n", recorded.folder.filename().string(), pairs.size(),
             returns.lost, returns.different, noise.motions, cells(noise));
  return 0;
}

}  // namespace
}  // namespace plvo::bench

int main(int argc, char** argv) {
  std::vector<std::string> words(argv + 1, argv + argc);
  const bool returns = !words.empty() && words[0] == "--returns";
  if (words.size() < 3 || (returns && words.size() > 4)) {
    fmt::print(stderr,
               "usage: truth_noise GROUNDTRUTH TRAJECTORY TRAJECTORY...\n"
               "       truth_noise --returns SEQUENCE CAMERA_MODEL [TRAJECTORY]\n");
    return 2;
  }
  if (!returns) return plvo::bench::study_frames(words);
  words.resize(4);
  return plvo::bench::study_returns(words[1], words[2], words[3]);
}
