// SPDX-License-Identifier: Apache-2.0
// `plvo eval --plot`: one picture of one or several evaluations against the same ground truth.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "plvo/base/status.hpp"
#include "plvo/eval/evaluation.hpp"

namespace plvo::report {

struct PlottedEstimate {
  std::string label;
  const eval::Evaluation* evaluation = nullptr;
};

// Returns an SVG with five charts. Trajectory: the two coordinates of the truth's world in which it extends
// furthest, the estimates aligned to the truth as for the ATE. Over time: errors of position and orientation,
// truth and estimate sharing the first pose. Over the distance travelled: relative errors of translation and
// rotation. A curve is broken where frames are lost.
std::string make_plot(const std::string& title, const std::vector<PlottedEstimate>& estimates);

// Returns kIo with the operating system's reason.
Status write_plot(const std::filesystem::path& path, const std::string& title,
                  const std::vector<PlottedEstimate>& estimates);

}  // namespace plvo::report
