// SPDX-License-Identifier: Apache-2.0
#include "plvo/bench/detectors/compare.hpp"

#include "plvo/bench/jobs/campaign.hpp"
#include "plvo/host/posix_clock.hpp"

namespace plvo::bench {
namespace {

// Runs every detector over a view before the next view, so that the load of the machine affects all of them
// alike. found[k][i]: the features of detector k in view i.
template <typename Finder, typename Found, typename Select>
std::vector<NamedScore> find_all(const ViewSequence& sequence, const std::vector<Finder>& finders,
                                 const Select& select, std::vector<std::vector<Found>>& found) {
  std::vector<NamedScore> scores;
  for (const Finder& finder : finders) scores.push_back({finder.name, {}});
  found.resize(finders.size());
  for (const View& view : sequence.views) {
    for (std::size_t k = 0; k < finders.size(); ++k) {
      const std::int64_t start = posix_thread_cpu_ns();
      auto all = finders[k].find(view.image());
      scores[k].score.ms.push_back(static_cast<double>(posix_thread_cpu_ns() - start) * 1e-6);
      found[k].push_back(select(std::move(all)));
    }
  }
  return scores;
}

}  // namespace

DetectorComparison compare_detectors(const ViewSequence& sequence, const DetectorCapacity& capacity,
                                     const ScoreOptions& options) {
  DetectorComparison comparison;
  std::vector<SegmentFinder> segment_finders = {own_segment_finder(capacity)};
  for (const SegmentFinder& finder : opencv_segment_finders()) segment_finders.push_back(finder);
  std::vector<std::vector<std::vector<Line>>> lines;
  comparison.segments = find_all(
      sequence, segment_finders,
      [&](std::vector<Line> all) {
        return longest(std::move(all), options.min_length_px, static_cast<std::size_t>(capacity.segments));
      },
      lines);
  for (std::size_t k = 0; k < lines.size(); ++k)
    score_segments(sequence, lines[k], options, comparison.segments[k].score);

  std::vector<PointFinder> point_finders = {own_point_finder(capacity)};
  for (const PointFinder& finder : opencv_point_finders(capacity)) point_finders.push_back(finder);
  std::vector<std::vector<std::vector<Vector2>>> points;
  comparison.points = find_all(
      sequence, point_finders,
      [&](std::vector<FoundPoint> all) {
        return strongest(std::move(all), static_cast<std::size_t>(capacity.keypoints));
      },
      points);
  for (std::size_t k = 0; k < points.size(); ++k)
    score_points(sequence, points[k], options, comparison.points[k].score);
  return comparison;
}

double time_ratio(const Score& score, const Score& ours) {
  std::vector<double> ratios;
  for (std::size_t i = 0; i < score.ms.size(); ++i) ratios.push_back(score.ms[i] / ours.ms[i]);
  return median(ratios);
}

}  // namespace plvo::bench
