// SPDX-License-Identifier: Apache-2.0
#include "plvo/calibrate/timing_search.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "plvo/calibrate/quadratic_fit.hpp"
#include "plvo/calibrate/stamp_jitter.hpp"

namespace plvo::calibrate {
namespace {

using Eigen::MatrixXd;

constexpr std::size_t kLeastPairs = 40;
constexpr double kLeastTurn_rad_per_s = 0.1;
constexpr std::size_t kRoughPairs = 120;  // enough for the rough search and for the curves
constexpr int kMostPasses = 8;
constexpr double kMost_s = 0.095;  // limit of each unknown, within the limits of CameraModel::validate
constexpr std::int64_t kBlock_ns = 1'000'000'000;

// The unknowns as a vector: delay, depth readout, readout.
Vector3 vector_of(const SensorTiming& t) { return {t.depth_delay_s, t.depth_readout_s, t.readout_s}; }
SensorTiming timing_at(const Vector3& x) { return {x.x(), x.y(), x.z()}; }
Vector3 bounded(const Vector3& x) {
  return {std::clamp(x.x(), -kMost_s, kMost_s), std::clamp(x.y(), 0.0, kMost_s),
          std::clamp(x.z(), 0.0, kMost_s)};
}

// Returns nearly independent search directions, one per column, scaled to a half-width: the delay; the depth
// readout alone; both readouts together, unless colour has a global shutter.
MatrixXd search_directions(bool readouts, bool global_shutter) {
  MatrixXd steps(3, 3);
  steps << 0.004, 0, 0, 0, 0.008, 0.006, 0, 0, 0.006;
  return steps.leftCols(!readouts ? 1 : global_shutter ? 2 : 3);
}

std::string words_of(const Vector3& x) {
  return fmt::format("delay {:+.1f} ms, depth readout {:.1f} ms, readout {:.1f} ms", 1e3 * x.x(), 1e3 * x.y(),
                     1e3 * x.z());
}

class Search {
 public:
  Search(const TimingSearch& task, TimingResult& result) : task_(task), result_(result) {}

  Status run() {
    x_ = bounded(vector_of(task_.start));
    for (int pass = 0; pass < kMostPasses && !result_.settled; ++pass) {
      pass_ = pass;
      if (Status status = look_again(); !status.ok()) return status;
      task_.on_result(fmt::format("pass {}: {} frames tracked, {} pairs to compare", pass + 1, result_.frames,
                                  result_.pairs));
      if (pass == 0) rough_search();
      const Vector3 before = x_;
      fine_search();
      result_.passes.push_back(timing_at(x_));
      task_.on_result(fmt::format("pass {}: {}", pass + 1, words_of(x_)));
      result_.settled = pass > 0 && is_small(x_ - before);
    }
    result_.timing = timing_at(x_);
    draw_curves();
    return {};
  }

 private:
  // True if the change is below what matters or below what the recordings determine.
  bool is_small(const Vector3& change) const {
    constexpr std::array<double, 3> kMatters_s = {0.0003, 0.001, 0.001};
    for (std::size_t i = 0; i < 3; ++i) {
      const double sigma_s = result_.sigma_s[i];
      if (!std::isfinite(sigma_s) || std::abs(change(static_cast<int>(i))) > kMatters_s[i] + 0.5 * sigma_s)
        return false;
    }
    return true;
  }

  Status look_again() {
    recordings_.clear();
    if (Status status = task_.track(timing_at(x_), recordings_); !status.ok()) return status;
    result_.frames = result_.pairs = 0;
    result_.stamp_sigma_s = stamp_jitter_s(recordings_);
    double turn = 0;
    std::size_t turns = 0;
    for (const TrackedRecording& recording : recordings_) {
      result_.frames += recording.frames.size();
      result_.pairs += recording.pairs.size();
      for (const FramePair& pair : recording.pairs) {
        turn += recording.frames[pair.current].velocity.tail<3>().squaredNorm();
        ++turns;
      }
    }
    result_.turn_rad_per_s = turns > 0 ? std::sqrt(turn / static_cast<double>(turns)) : 0;
    if (result_.pairs < kLeastPairs)
      return Status(
          StatusCode::kTooFewFeatures,
          fmt::format("only {} of {} frames could be tracked, {} are the least; record 10 s or more of a "
                      "textured scene 1 to 3 m away",
                      result_.pairs, result_.frames, kLeastPairs));
    if (result_.turn_rad_per_s < kLeastTurn_rad_per_s)
      return Status(
          StatusCode::kDegenerate,
          fmt::format(
              "the camera hardly turns ({:.1f} deg/s), so its timing cannot be measured; turn the camera: "
              "left and right, up and down, about its axis, 20 to 60 deg/s, all the while",
              kDegrees * result_.turn_rad_per_s));
    return {};
  }

  // Sets what the next `places` costs are for, for the progress line.
  void begin(const char* what, Eigen::Index places) {
    what_ = what;
    places_ = places;
    place_ = 0;
  }
  // Returns the cost of each pair.
  std::vector<double> costs_at(const Vector3& x, std::size_t step) {
    task_.on_progress(fmt::format("pass {}: {} {}/{}, {}", pass_ + 1, what_, ++place_, places_, words_of(x)));
    return disagreement(recordings_, timing_at(x), step, task_.threads);
  }
  double cost_at(const Vector3& x, std::size_t step) {
    const std::vector<double> costs = costs_at(x, step);
    return std::accumulate(costs.begin(), costs.end(), 0.0);
  }
  std::size_t rough_step() const { return std::max<std::size_t>(1, result_.pairs / kRoughPairs); }

  // Sets x_ to the best of x_ + k step, k = −reach … reach.
  void rough_line(const Vector3& step, int reach) {
    const Vector3 centre = x_;
    double least = std::numeric_limits<double>::infinity();
    for (int k = -reach; k <= reach; ++k) {
      const Vector3 x = bounded(centre + k * step);
      const double cost = cost_at(x, rough_step());
      if (cost < least) {
        least = cost;
        x_ = x;
      }
    }
  }

  void rough_search() {
    struct Line {
      Vector3 step;
      int reach;
    };
    std::vector<Line> lines = {{{0.010, 0, 0}, 5}};
    if (task_.find_readouts) lines.insert(lines.end(), {{{0, 0.008, 0.008}, 4}, {{0, 0.010, 0}, 3}});
    lines.push_back({{0.004, 0, 0}, 3});
    Eigen::Index places = 0;
    for (const Line& line : lines) places += 2 * line.reach + 1;
    begin("rough search", places);
    for (const Line& line : lines) rough_line(line.step, line.reach);
  }

  // Returns for each pair the running number of its block: one second of one recording.
  std::vector<Eigen::Index> blocks() const {
    std::vector<Eigen::Index> block;
    Eigen::Index number = -1;
    for (const TrackedRecording& recording : recordings_) {
      std::int64_t second = -1;
      for (const FramePair& pair : recording.pairs) {
        const std::int64_t now =
            (recording.frames[pair.current].stamp_ns - recording.frames.front().stamp_ns) / kBlock_ns;
        if (now != second) ++number;
        second = now;
        block.push_back(number);
      }
    }
    return block;
  }

  // Compares a readout of 0 with a small one: no surface can be fitted across 0, because the readout is not
  // negative.
  void look_for_global_shutter() {
    constexpr double kLittle_s = 0.005;
    result_.global_shutter = false;
    if (!task_.find_readouts || x_.z() >= kLittle_s) return;
    const Vector3 none(x_.x(), x_.y(), 0), some(x_.x(), x_.y(), kLittle_s);
    begin("global shutter", 2);
    const double cost_of_none = cost_at(none, 1), cost_of_some = cost_at(some, 1);
    result_.global_shutter = cost_of_none < cost_of_some;
    if (result_.global_shutter) x_ = none;
  }

  void fine_search() {
    look_for_global_shutter();
    const MatrixXd steps = search_directions(task_.find_readouts, result_.global_shutter);
    const Eigen::Index n = steps.cols();
    const MatrixXd design = quadratic_design(static_cast<int>(n));
    const std::vector<Eigen::Index> block = blocks();
    // Centre the design so that no place has a readout below 0.
    Vector3 centre = x_;
    centre.z() = std::max(centre.z(), steps.row(2).sum());
    MatrixXd costs = MatrixXd::Zero(block.back() + 1, design.rows());
    begin("fine search", design.rows());
    for (Eigen::Index place = 0; place < design.rows(); ++place) {
      const std::vector<double> sums = costs_at(centre + steps * design.row(place).transpose(), 1);
      for (std::size_t i = 0; i < sums.size(); ++i) costs(block[i], place) += sums[i];
    }
    const QuadraticMinimum minimum = fit_quadratic(design, costs);
    x_ = bounded(centre + steps * minimum.place);
    const MatrixXd covariance = steps * minimum.covariance * steps.transpose();
    for (Eigen::Index i = 0; i < 3; ++i) {
      const bool sought = i == 0 || (task_.find_readouts && !(i == 2 && result_.global_shutter));
      const double sigma = minimum.convex && minimum.covariance.allFinite()
                               ? std::sqrt(covariance(i, i))
                               : std::numeric_limits<double>::infinity();
      result_.sigma_s[static_cast<std::size_t>(i)] = sought ? sigma : 0;
    }
  }

  void draw_curves() {
    constexpr int kReach = 5;
    constexpr double kStep_s = 0.005;
    std::size_t matches = 0, number = 0;
    for (const TrackedRecording& recording : recordings_)
      for (const FramePair& pair : recording.pairs)
        if (number++ % rough_step() == 0) matches += pair.points.size() + pair.lines.size();
    std::vector<std::pair<int, Vector3>> places;
    for (int i = 0; i < 3; ++i)
      for (int k = -kReach; k <= kReach; ++k) {
        Vector3 x = x_;
        x(i) += k * kStep_s;
        if (bounded(x) == x) places.emplace_back(i, x);
      }
    begin("curves", static_cast<Eigen::Index>(places.size()));
    for (const auto& [i, x] : places) {
      const double cost = cost_at(x, rough_step());
      result_.curves[static_cast<std::size_t>(i)].push_back(
          {x(i), cost / static_cast<double>(std::max<std::size_t>(1, matches))});
    }
  }

  const TimingSearch& task_;
  TimingResult& result_;
  std::vector<TrackedRecording> recordings_;
  Vector3 x_ = Vector3::Zero();
  int pass_ = 0;
  const char* what_ = "";
  Eigen::Index place_ = 0, places_ = 0;
};

}  // namespace

Status find_timing(const TimingSearch& search, TimingResult& result) {
  result = {};
  return Search(search, result).run();
}

}  // namespace plvo::calibrate
