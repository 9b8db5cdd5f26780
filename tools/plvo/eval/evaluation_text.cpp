// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <iterator>

#include "plvo/eval/evaluation.hpp"
#include "plvo/host/files/stamp_text.hpp"
#include "plvo/math/trigonometry.hpp"

namespace plvo::eval {
namespace {

constexpr std::size_t kListedIntervals = 10;

struct Text {
  std::string out;
  template <typename... Args>
  void line(fmt::format_string<Args...> format, Args&&... args) {
    fmt::format_to(std::back_inserter(out), format, std::forward<Args>(args)...);
    out += '\n';
  }
};

std::string delta_name(const RpeDelta& delta) {
  if (delta.text == "1f") return "RPE per frame";
  if (delta.text == "1s") return "RPE per second";
  return "RPE over " + delta.text;
}

void add_truth_fit(Text& text, const TruthFit& fit, const RpeErrors& before) {
  const Vector3 deg = fit.rotation_rad * (180 / kPi), sigma_deg = fit.rotation_sigma_rad * (180 / kPi);
  text.line(
      "truth fitted to the estimate (standard deviation): turned by {:.2f} ({:.2f}), {:.2f} ({:.2f}), {:.2f} "
      "({:.2f}) deg, "
      "clock {:.1f} ({:.1f}) ms; all figures are after it, RPE per second before: {:.3f} mm, {:.4f} deg",
      deg.x(), sigma_deg.x(), deg.y(), sigma_deg.y(), deg.z(), sigma_deg.z(), 1e3 * fit.clock_s,
      1e3 * fit.clock_sigma_s, 1e3 * before.translation_m.rmse, before.rotation_deg.rmse);
}

void add_rpe(Text& text, const RpeResult& r) {
  const auto row = [&text](const std::string& name, const char* who, const RpeErrors& e) {
    const Statistics& t = e.translation_m;
    const Statistics& a = e.rotation_deg;
    text.line("{:<18} {:<9} {:10.3f} {:9.3f} {:9.3f} {:9.3f}   {:8.4f} {:8.4f} {:8.4f} {:8.4f}", name, who,
              1e3 * t.rmse, 1e3 * t.median, 1e3 * t.p95, 1e3 * t.max, a.rmse, a.median, a.p95, a.max);
  };
  if (r.estimate.translation_m.count == 0) {
    text.line("{:<18} no two poses are that far apart", delta_name(r.delta));
    return;
  }
  row(delta_name(r.delta), "estimate", r.estimate);
  row("", "identity", r.identity);
}

void add_ate(Text& text, const Evaluation& e) {
  const auto row = [&text](const char* name, const char* who, const Statistics& s) {
    text.line("{:<18} {:<9} {:10.3f} {:9.3f} {:9.3f} {:9.3f}", name, who, 1e3 * s.rmse, 1e3 * s.median,
              1e3 * s.p95, 1e3 * s.max);
  };
  row("ATE", "estimate", e.ate.position_m);
  row("", "identity", e.ate_identity);
  const double percent = e.path_m > 0 ? 100 * e.drift.translation_m / e.path_m : 0;
  text.line("{:<18} {:<9} {:10.3f} mm ({:.2f} % of the path) {:8.4f} deg", "end-point drift", "estimate",
            1e3 * e.drift.translation_m, percent, e.drift.rotation_deg);
  text.line("{:<18} {:<9} {:10.3f} mm {:8.4f} deg", "", "identity", 1e3 * e.drift_identity.translation_m,
            e.drift_identity.rotation_deg);
}

void add_nees(Text& text, const char* name, const Consistency& c) {
  if (c.count == 0) {
    text.line("{:<18} no sample: recording too short, or no ground truth, or no usable covariance", name);
    return;
  }
  const auto row = [&text](const char* title, const char* kind, const Nees& n) {
    text.line("{:<18} {:<14} {:9.2f} ({:.2f} to {:.2f}) {:9.2f} ({:.2f} to {:.2f})  {:5.1f} %", title, kind,
              n.mean, n.mean_band.low, n.mean_band.high, n.median, n.median_band.low, n.median_band.high,
              100 * n.inside_95);
  };
  row(name, "all, 6", c.all);
  row("", "translation, 3", c.translation);
  row("", "rotation, 3", c.rotation);
  text.line("{:<18} {} samples, {} of them apart{}{}", "", c.count, c.independent,
            c.singular > 0 ? fmt::format("; {} covariances cannot be inverted", c.singular) : "",
            c.broken > 0 ? fmt::format("; {} left out, frames are lost in between", c.broken) : "");
}

void add_all_nees(Text& text, const Evaluation& e) {
  if (!e.pose_nees && !e.motion_nees) return;
  text.line("\n{:<18} {:<14} {:>9} {:<16} {:>9} {:<16} {}", "NEES", "error, expected", "mean",
            "(95 % if true)", "median", "(95 % if true)", "inside 95 %");
  if (e.pose_nees) add_nees(text, "of the poses", *e.pose_nees);
  if (e.motion_nees) add_nees(text, "of the motions", *e.motion_nees);
  if (e.second_nees) add_nees(text, "over a second", *e.second_nees);
  if (e.truth_sigma.position_m > 0 || e.truth_sigma.orientation_rad > 0) {
    text.line("{:<18} of a true pose, in the covariance as well: {:.3f} mm, {:.4f} deg in each axis",
              "standard deviation", 1e3 * e.truth_sigma.position_m,
              e.truth_sigma.orientation_rad * 180 / kPi);
  }
}

void add_intervals(Text& text, const char* name, const std::vector<Interval>& intervals) {
  if (intervals.empty()) return;
  text.line("{}: {}", name, intervals.size());
  for (std::size_t i = 0; i < intervals.size() && i < kListedIntervals; ++i) {
    text.line("  {} to {} ({:.3f} s)", format_stamp(intervals[i].begin_ns), format_stamp(intervals[i].end_ns),
              static_cast<double>(intervals[i].end_ns - intervals[i].begin_ns) * 1e-9);
  }
  if (intervals.size() > kListedIntervals) text.line("  and {} more", intervals.size() - kListedIntervals);
}

}  // namespace

std::string to_text(const Evaluation& e) {
  Text text;
  text.line("{} of {} poses have ground truth ({}); {:.3f} s, {:.3f} m", e.poses.truth.size(),
            e.estimate_poses, e.sampling == GroundTruthSampling::kNearest ? "nearest stamp" : "interpolated",
            e.duration_s, e.path_m);
  if (e.truth_fit) add_truth_fit(text, *e.truth_fit, e.second_before_fit);
  text.line("identity: the zero-motion baseline, an estimate without any motion\n");
  text.line("{:<28} {:>10} {:>9} {:>9} {:>9}   {:>8} {:>8} {:>8} {:>8}", "", "RMSE mm", "median", "p95",
            "max", "RMSE deg", "median", "p95", "max");
  for (const RpeResult& r : e.rpe) add_rpe(text, r);
  add_ate(text, e);
  if (!e.by_distance.empty()) {
    text.line("\nerror against distance: mean (p95) drift over sub-trajectories");
    for (const DistanceError& d : e.by_distance) {
      text.line("  {:7.1f} m {:8.3f} % ({:.3f}) {:9.4f} deg/m ({:.4f})  {} sub-trajectories", d.length_m,
                d.translation_percent.mean, d.translation_percent.p95, d.rotation_deg_per_m.mean,
                d.rotation_deg_per_m.p95, d.translation_percent.count);
    }
  }
  add_all_nees(text, e);
  add_intervals(text, "\nintervals without a pose (lost)", e.lost);
  add_intervals(text, "\nposes without ground truth", e.without_truth);
  return text.out;
}

}  // namespace plvo::eval
