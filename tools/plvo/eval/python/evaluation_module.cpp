// SPDX-License-Identifier: Apache-2.0
// plvo._evaluation: `plvo eval` for Python. plvo/__init__.py converts its JSON to a dictionary.
#include <pybind11/pybind11.h>

#include <nlohmann/json.hpp>
#include <string>

#include "plvo/eval/evaluation.hpp"
#include "plvo/host/files/trajectory_file.hpp"
#include "plvo/python/arguments.hpp"
#include "plvo/python/error.hpp"
#include "plvo/recording/recording.hpp"

namespace plvo::eval {
namespace {

namespace py = pybind11;
using python::argument;
using python::throw_unless_ok;

struct Estimate {
  Trajectory trajectory;
  std::vector<StampedCovariance> covariances;
  std::vector<UncertainMotion> motions;
};

Estimate estimate_of(const py::iterable& results) {
  Estimate estimate;
  for (const py::handle item : results) {
    const auto& result = argument<const TrackResult&>(item, "estimate", "plvo.Result objects");
    if (!has_pose(result)) continue;
    const std::vector<StampedPose>& poses = estimate.trajectory.poses;
    if (!poses.empty() && result.stamp_ns <= poses.back().stamp_ns)
      throw py::value_error("estimate: the stamps of the results must increase");
    estimate.trajectory.poses.push_back({result.stamp_ns, result.T_world_camera});
    estimate.covariances.push_back({result.stamp_ns, result.pose_covariance});
    if (result.state == TrackState::kTracking)
      estimate.motions.push_back(
          {result.stamp_ns, result.reference_stamp_ns, result.T_camera_reference, result.motion_covariance});
  }
  return estimate;
}

EvaluationOptions options_of(const std::string& sampling, double max_difference_s, double offset_s,
                             const py::iterable& deltas, double sigma_m, double sigma_rad, bool fit_truth) {
  EvaluationOptions options;
  if (sampling == "nearest")
    options.sampling.method = GroundTruthSampling::kNearest;
  else if (sampling != "interpolated")
    throw py::value_error("sampling: expected interpolated or nearest, got '" + sampling + "'");
  constexpr double kDay_s = 86400;
  if (!(max_difference_s > 0 && max_difference_s <= kDay_s) || !(offset_s >= -kDay_s && offset_s <= kDay_s))
    throw py::value_error("max_difference_s and offset_s must be seconds within a day");
  options.sampling.max_difference_ns = static_cast<std::int64_t>(max_difference_s * 1e9);
  options.offset_ns = static_cast<std::int64_t>(offset_s * 1e9);
  if (!(sigma_m >= 0 && sigma_m <= 1) || !(sigma_rad >= 0 && sigma_rad <= 1))
    throw py::value_error("truth_sigma must be metres and radians from 0 to 1");
  options.truth_sigma = {sigma_m, sigma_rad};
  if (fit_truth && options.sampling.method == GroundTruthSampling::kNearest)
    throw py::value_error(
        "fit_truth shifts the truth's clock, so that it is interpolated; leave sampling='nearest' away");
  options.fit_truth = fit_truth;
  for (const py::handle item : deltas) {
    RpeDelta delta;
    const std::string text = python::text(item, "rpe_deltas");
    if (!parse_rpe_delta(text, delta))
      throw py::value_error("rpe_deltas: expected frames, seconds or metres such as 1f, 0.5s or 2m, got '" +
                            text + "'");
    options.deltas.push_back(delta);
  }
  return options;
}

// estimated: results, or bytes with the path of a file.
std::string evaluate_json(const py::object& truth, const py::object& estimated, const std::string& sampling,
                          double max_difference_s, double offset_s, const py::iterable& deltas,
                          std::pair<double, double> truth_sigma, bool fit_truth) {
  const EvaluationOptions options = options_of(sampling, max_difference_s, offset_s, deltas,
                                               truth_sigma.first, truth_sigma.second, fit_truth);
  const std::string truth_path = python::path_bytes(truth);
  Trajectory true_poses;
  throw_unless_ok(is_recording(truth_path) ? read_true_poses(truth_path, {}, true_poses)
                                           : read_trajectory({truth_path, {}, {}}, true_poses));
  Estimate estimate;
  if (py::isinstance<py::bytes>(estimated))
    throw_unless_ok(read_trajectory({python::path_bytes(estimated), {}, {}}, estimate.trajectory));
  else
    estimate = estimate_of(
        argument<py::iterable>(estimated, "estimate", "a file or an iterable of plvo.Result objects"));
  for (const StampedPose& pose : estimate.trajectory.poses)
    if (pose.stamp_ns <= INT64_MIN / 2 || pose.stamp_ns >= INT64_MAX / 2)
      throw py::value_error("the estimate has stamps beyond 146 years");
  Evaluation evaluation;
  throw_unless_ok(
      evaluate(true_poses, estimate.trajectory, estimate.covariances, estimate.motions, options, evaluation));
  nlohmann::ordered_json json = to_json(evaluation);
  json["warnings"] = doubts_about(evaluation);
  return json.dump();
}

}  // namespace
}  // namespace plvo::eval

PYBIND11_MODULE(_evaluation, module) { module.def("evaluate", &plvo::eval::evaluate_json); }
