// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>

#include "plvo/bench/map/closed_sequence.hpp"
#include "plvo/bench/map/evaluation.hpp"
#include "plvo/bench/map/studies.hpp"
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
  const ClosedSequence sequence(simulated(study.scene, study.light, study.seed, study.width, study.amount));
  MapEvaluation evaluation(sequence.camera(), 256);
  std::int64_t number = 0;
  for (int round = 0; round < kMostRounds && !evaluation.map.graph().full(); ++round)
    for (int k = 0; k < sequence.frames(); ++k, ++number)
      evaluation.see(sequence.frame(number), sequence.pose(number));
  const std::vector<std::byte> file = evaluation.save();
  const std::size_t keyframes = evaluation.map.graph().size();
  const auto frames = static_cast<std::size_t>(sequence.frames());
  std::vector<double> track(frames, 1e9), map(frames, 1e9);
  int joined = 0;  // keyframes, in a round
  for (int repetition = 0; repetition < kRepetitions; ++repetition) {
    evaluation.load(file);
    const int before = evaluation.map.counts().keyframes;
    for (std::size_t k = 0; k < frames; ++k) {
      const auto at = number + static_cast<std::int64_t>(k);
      evaluation.see(sequence.frame(at), sequence.pose(at));
      track[k] = std::min(track[k], evaluation.track_ms().back());
      map[k] = std::min(map[k], evaluation.map_ms().back());
    }
    joined = evaluation.map.counts().keyframes - before;
  }
  std::vector<double> both;
  for (std::size_t k = 0; k < frames; ++k) both.push_back(track[k] + map[k]);
  // Median, mean, 99th percentile and greatest, ms.
  fmt::print("{{\"keyframes\": {}, \"joined\": {}, {}, {}, {}}}\n", keyframes, joined,
             figures("track", track), figures("map", map), figures("both", both));
}

}  // namespace plvo::bench
