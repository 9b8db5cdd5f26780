// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>

#include "plvo/eval/evaluation.hpp"
#include "plvo/host/files/stamp_text.hpp"
#include "plvo/math/trigonometry.hpp"

namespace plvo::eval {
namespace {

using Json = nlohmann::ordered_json;

Json to_json(const Statistics& s) {
  return {{"rmse", s.rmse}, {"mean", s.mean}, {"median", s.median},
          {"p90", s.p90},   {"p95", s.p95},   {"max", s.max}};
}

Json to_json(const RpeErrors& errors) {
  return {{"translation_m", to_json(errors.translation_m)}, {"rotation_deg", to_json(errors.rotation_deg)}};
}

Json to_json(const EndDrift& drift) {
  return {{"translation_m", drift.translation_m}, {"rotation_deg", drift.rotation_deg}};
}

Json to_json(const TruthFit& fit, const RpeErrors& before) {
  const auto degrees = [](const Vector3& radians) {
    const Vector3 v = radians * (180 / kPi);
    return Json{v.x(), v.y(), v.z()};
  };
  return {{"rotation_deg", degrees(fit.rotation_rad)},
          {"rotation_sigma_deg", degrees(fit.rotation_sigma_rad)},
          {"clock_ms", 1e3 * fit.clock_s},
          {"clock_sigma_ms", 1e3 * fit.clock_sigma_s},
          {"motions", fit.motions},
          {"independent", fit.independent},
          {"second_before", to_json(before)}};
}

Json to_json(const Nees& n) {
  return {{"expected", n.dof},
          {"mean", n.mean},
          {"mean_band_95", {n.mean_band.low, n.mean_band.high}},
          {"median", n.median},
          {"median_band_95", {n.median_band.low, n.median_band.high}},
          {"inside_95_percent_bound", n.inside_95}};
}

Json to_json(const Consistency& c) {
  Json json = {
      {"samples", c.count}, {"independent", c.independent}, {"singular", c.singular}, {"broken", c.broken}};
  if (c.count == 0) return json;
  json.update(to_json(c.all));
  json["translation"] = to_json(c.translation);
  json["rotation"] = to_json(c.rotation);
  return json;
}

Json to_json(const std::vector<Interval>& intervals) {
  Json list = Json::array();
  for (const Interval& i : intervals) {
    list.push_back({{"begin", format_stamp(i.begin_ns)},
                    {"end", format_stamp(i.end_ns)},
                    {"seconds", static_cast<double>(i.end_ns - i.begin_ns) * 1e-9}});
  }
  return list;
}

}  // namespace

nlohmann::ordered_json to_json(const Evaluation& e) {
  Json json;
  json["ground_truth_sampling"] = e.sampling == GroundTruthSampling::kNearest ? "nearest" : "interpolated";
  json["ground_truth_sigma"] = {{"position_m", e.truth_sigma.position_m},
                                {"orientation_rad", e.truth_sigma.orientation_rad}};
  if (e.truth_fit) json["truth_fit"] = to_json(*e.truth_fit, e.second_before_fit);
  json["estimate_poses"] = e.estimate_poses;
  json["poses"] = e.poses.truth.size();
  json["duration_s"] = e.duration_s;
  json["path_m"] = e.path_m;
  json["rpe"] = Json::array();
  for (const RpeResult& r : e.rpe) {
    Json entry = {{"delta", r.delta.text}, {"pairs", r.estimate.translation_m.count}};
    entry.update(to_json(r.estimate));
    entry["identity"] = to_json(r.identity);
    json["rpe"].push_back(entry);
  }
  json["ate_m"] = to_json(e.ate.position_m);
  json["ate_m"]["identity"] = to_json(e.ate_identity);
  json["scale"] = {{"best_fit", e.ate.scale}, {"ate_rmse_m", e.ate.scaled_rmse_m}};
  json["end_drift"] = to_json(e.drift);
  json["end_drift"]["percent_of_path"] = e.path_m > 0 ? Json(100 * e.drift.translation_m / e.path_m) : Json();
  json["end_drift"]["identity"] = to_json(e.drift_identity);
  json["by_distance"] = Json::array();
  for (const DistanceError& d : e.by_distance) {
    json["by_distance"].push_back({{"length_m", d.length_m},
                                   {"sub_trajectories", d.translation_percent.count},
                                   {"translation_percent", to_json(d.translation_percent)},
                                   {"rotation_deg_per_m", to_json(d.rotation_deg_per_m)}});
  }
  if (e.pose_nees) json["nees_pose"] = to_json(*e.pose_nees);
  if (e.motion_nees) json["nees_motion"] = to_json(*e.motion_nees);
  if (e.second_nees) json["nees_second"] = to_json(*e.second_nees);
  json["lost"] = to_json(e.lost);
  json["without_ground_truth"] = to_json(e.without_truth);
  return json;
}

}  // namespace plvo::eval
