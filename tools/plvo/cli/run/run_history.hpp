// SPDX-License-Identifier: Apache-2.0
// What a run keeps to speak about itself at the end: the poses, to be compared with the ground truth where
// there is one, and for a report the figures of every frame and the pictures of some.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "plvo/cli/common/frame_record.hpp"
#include "plvo/cli/options/camera_options.hpp"
#include "plvo/cli/run/run_summary.hpp"
#include "plvo/report/report.hpp"

namespace plvo::cli {

class RunHistory {
 public:
  // with_report: keep what a report needs, and pictures of about `pictures` frames. expected_frames: room
  // made (and touched) at once, so that a run without a report does not grow.
  RunHistory(bool with_report, std::size_t pictures, std::size_t expected_frames);

  // frame: null for a damaged one.
  void add(const FrameRecord& record, const RgbdFrame* frame, const Odometry& odometry);

  // Compares with the truth, where there is one and two poses or more. Not ok, and no evaluation, when the
  // truth cannot be read, or as eval::evaluate().
  Status evaluate(const OpenedCamera& camera);
  const std::optional<eval::Evaluation>& evaluation() const { return report_.evaluation; }

  Status write_report(const std::string& path, const RunSummary& summary);

 private:
  bool with_report_;
  report::FrameRecorder recorder_;
  report::SceneRecorder scene_;
  report::ReportInput report_;
  std::vector<eval::StampedCovariance> covariances_;
  std::vector<eval::UncertainMotion> motions_;
};

}  // namespace plvo::cli
