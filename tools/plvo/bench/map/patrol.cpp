// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>
#include <memory>

#include "plvo/bench/map/evaluation.hpp"
#include "plvo/bench/map/studies.hpp"
#include "plvo/eval/alignment.hpp"
#include "plvo/eval/statistics.hpp"
#include "plvo/simulator/simulated_camera.hpp"

namespace plvo::bench {

void patrol(const MapStudy& study) {
  const SimulatorOptions options = simulated(study.scene, study.light, study.seed, study.width, study.amount);
  std::unique_ptr<SimulatedCamera> camera;
  need(SimulatedCamera::create(options, camera));
  MapEvaluation evaluation(camera->model(), 256);
  int recognised = 0;
  RgbdFrame frame;
  for (int k = 0; k < study.amount && camera->next(frame).ok(); ++k) {
    evaluation.see(frame, camera->pose(k));
    recognised += evaluation.in_map.recognised ? 1 : 0;
  }
  evaluation.settle();
  const MapEvaluation::Poses poses = evaluation.poses();
  std::vector<double> distances, angles;
  for (const PoseError& error : evaluation.loops()) {
    distances.push_back(error.m);
    angles.push_back(error.rad);
  }
  const eval::Statistics m = eval::statistics(distances), rad = eval::statistics(angles);
  const eval::Statistics track = eval::statistics(evaluation.track_ms()),
                         map = eval::statistics(evaluation.map_ms());
  const Map::Counts& counts = evaluation.map.counts();
  fmt::print(
      "{{\"lost\": {}, \"posed\": {}, \"placed\": {}, \"keyframes\": {}, \"removed\": {}, \"compared\": {}, "
      "\"accepted\": {}, \"recognised\": {}, \"loops\": {}, \"judged\": {}, \"wrong\": {}, "
      "\"loop_median_m\": {:.5f}, \"loop_max_m\": {:.5f}, \"loop_max_rad\": {:.5f}, \"odometry_ate_m\": "
      "{:.5f}, "
      "\"map_ate_m\": {:.5f}, \"track_median_ms\": {:.4f}, \"map_mean_ms\": {:.4f}}}\n",
      evaluation.lost(), poses.frames, poses.truth.size(), evaluation.map.graph().size(), counts.removed,
      counts.compared, counts.accepted, recognised, counts.loops, evaluation.loops().size(),
      evaluation.wrong_loops(), m.median, m.max, rad.max,
      poses.truth.empty() ? 0 : eval::absolute_trajectory_error(poses.odometry, poses.truth).position_m.rmse,
      poses.truth.empty() ? 0 : eval::absolute_trajectory_error(poses.map, poses.truth).position_m.rmse,
      track.median, map.mean);
}

}  // namespace plvo::bench
