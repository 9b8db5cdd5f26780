// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <cmath>

#include "plvo/bench/map/closed_sequence.hpp"
#include "plvo/bench/map/evaluation.hpp"
#include "plvo/bench/map/studies.hpp"
#include "plvo/host/files/trajectory_file.hpp"
#include "plvo/host/resident_memory.hpp"

namespace plvo::bench {
namespace {

constexpr int kFramesOfARound = 400;
constexpr int kKeyframes = 128;

}  // namespace

void soak(const MapStudy& study) {
  const ClosedSequence sequence(
      simulated(study.scene, study.light, study.seed, study.width, kFramesOfARound));
  MappedOdometry mapped(sequence.camera(), kKeyframes);
  Odometry& odometry = mapped.odometry;
  Map& map = mapped.map;
  const Se3 T_map_room = sequence.pose(0).inverse();
  // [round, lost, keyframes, loops so far, RMS error of the odometry and in the map (m), resident bytes] of
  // each round. Room is taken before the first frame, so that the list takes none.
  const std::int64_t rounds = study.amount / kFramesOfARound;
  std::string text;
  text.reserve(static_cast<std::size_t>(rounds) * 120);
  for (std::int64_t round = 0; round < rounds; ++round) {
    int lost = 0, placed = 0, posed = 0;
    double odometry_sum = 0, map_sum = 0;
    for (std::int64_t k = 0; k < kFramesOfARound; ++k) {
      const std::int64_t number = round * kFramesOfARound + k;
      const TrackResult result = odometry.track(sequence.frame(number));
      const MapResult in_map = map.update(odometry, result);
      lost += result.state == TrackState::kLost ? 1 : 0;
      if (!has_pose(result)) continue;
      const Vector3 truth = T_map_room * sequence.pose(number).t;
      ++posed;
      odometry_sum += (result.T_world_camera.t - truth).squaredNorm();
      if (!in_map.located) continue;
      ++placed;
      map_sum += (in_map.T_map_world * result.T_world_camera.t - truth).squaredNorm();
    }
    fmt::format_to(std::back_inserter(text), "{}[{}, {}, {}, {}, {:.5f}, {:.5f}, {}]", round == 0 ? "" : ", ",
                   round + 1, lost, map.graph().size(), map.counts().loops,
                   std::sqrt(odometry_sum / std::max(1, posed)), std::sqrt(map_sum / std::max(1, placed)),
                   resident_memory().anonymous);
  }
  fmt::print("{{\"capacity\": {}, \"rounds\": [{}]}}\n", kKeyframes, text);
}

}  // namespace plvo::bench
