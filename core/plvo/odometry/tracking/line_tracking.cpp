// SPDX-License-Identifier: Apache-2.0
#include "plvo/odometry/tracking/line_tracking.hpp"

namespace plvo {

void match_predicted_lines(const Pinhole& pinhole, const Exposure& exposure, const LineFeatures& reference,
                           std::span<const Line3d> reference_lines, const LineFeatures& current,
                           const Se3& T_current_reference, const LineMatchConfig& gates, Arena& scratch,
                           FixedVector<Match>& matches) {
  matches.clear();
  const ScratchScope scope(scratch);
  const std::span<Segment> predicted = scratch.take<Segment>("predicted segments", reference.count_3d);
  if (predicted.size() < reference.count_3d) return;
  for (std::size_t i = 0; i < predicted.size(); ++i)
    predicted[i] = project_line(pinhole, exposure.as_seen(T_current_reference * reference_lines[i].a),
                                exposure.as_seen(T_current_reference * reference_lines[i].b));
  match_lines(predicted, reference.descriptors_3d(), current.segments_3d(), current.descriptors_3d(), gates,
              scratch, matches);
}

}  // namespace plvo
