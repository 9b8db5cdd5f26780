// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>

#include "plvo/bench/map/closed_walk.hpp"
#include "plvo/bench/map/studies.hpp"
#include "plvo/bench/map/walker.hpp"
#include "plvo/eval/statistics.hpp"

namespace plvo::bench {
namespace {

// The map and the frames are the same in each repetition, to the bit. So the least time of a frame is the one
// that other programs of the machine disturbed least.
constexpr int kRepetitions = 5;
constexpr int kMostRounds = 20;  // until the map is full

std::string figures(const char* name, std::vector<double> ms) {
  double sum = 0;
  for (const double frame : ms) sum += frame;
  const double mean = sum / static_cast<double>(ms.size());
  std::sort(ms.begin(), ms.end());
  return fmt::format("\"{}\": [{:.4f}, {:.4f}, {:.4f}, {:.4f}]", name, eval::quantile(ms, 0.5), mean,
                     eval::quantile(ms, 0.99), ms.back());
}

}  // namespace

void cost(const MapStudy& study) {
  const ClosedWalk walk(simulated(study.scene, study.light, study.seed, study.width, study.amount));
  MapWalker walker(walk.camera(), 256);
  std::int64_t number = 0;
  for (int round = 0; round < kMostRounds && !walker.map.graph().full(); ++round)
    for (int k = 0; k < walk.frames(); ++k, ++number) walker.see(walk.frame(number), walk.pose(number));
  const std::vector<std::byte> file = walker.save();
  const std::size_t keyframes = walker.map.graph().size();
  const auto frames = static_cast<std::size_t>(walk.frames());
  std::vector<double> track(frames, 1e9), map(frames, 1e9);
  int joined = 0;  // keyframes, in a round
  for (int repetition = 0; repetition < kRepetitions; ++repetition) {
    walker.load(file);
    const int before = walker.map.counts().keyframes;
    for (std::size_t k = 0; k < frames; ++k) {
      const auto at = number + static_cast<std::int64_t>(k);
      walker.see(walk.frame(at), walk.pose(at));
      track[k] = std::min(track[k], walker.track_ms().back());
      map[k] = std::min(map[k], walker.map_ms().back());
    }
    joined = walker.map.counts().keyframes - before;
  }
  std::vector<double> both;
  for (std::size_t k = 0; k < frames; ++k) both.push_back(track[k] + map[k]);
  // Median, mean, 99th percentile and greatest, ms.
  fmt::print("{{\"keyframes\": {}, \"joined\": {}, {}, {}, {}}}\n", keyframes, joined,
             figures("track", track), figures("map", map), figures("both", both));
}

}  // namespace plvo::bench
