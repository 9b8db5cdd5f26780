// SPDX-License-Identifier: Apache-2.0
// Signs in an evaluation of errors that are mostly not those of the odometry.
#include <fmt/format.h>

#include <cmath>

#include "plvo/eval/evaluation.hpp"

namespace plvo::eval {
namespace {

constexpr double kUsualScale = 0.05;  // off by no more
constexpr double kExplained = 0.5;    // of the ATE, at most, may be left after scaling
// The ratio of the error that is left to that of the zero-motion baseline is the standard deviation of the
// scale, if the errors of all poses are one error. The scale must differ from 1 by so many.
constexpr double kScaleSigmas = 3;
constexpr double kFarNees = 2;  // times as much as expected, or as little

struct NamedNees {
  const char* of;
  const std::optional<Consistency>& nees;
};

std::string advice_for_large_nees(const Evaluation& e, double ratio) {
  const bool sigma = e.truth_sigma.position_m > 0 || e.truth_sigma.orientation_rad > 0;
  const char* noise =
      "each true pose has noise of its own: --gt-sigma METRES DEGREES adds it (motion capture: about "
      "0.0004 0.1)";
  const char* fit =
      "the truth's camera is turned against the real one and its clock is off: --fit-truth finds both and "
      "takes them out";
  const std::string widen =
      fmt::format("the covariance is too small, and its standard deviations should be {:.1f} times as large",
                  std::sqrt(ratio));
  if (e.truth_fit && sigma) return widen;
  std::string text = "most often that is the truth's error, which no covariance of the estimate has in it: ";
  if (!e.truth_fit) text += fit;
  if (!e.truth_fit && !sigma) text += "; ";
  if (!sigma) text += noise;
  return text + ". Where the truth is exact, as a simulator's is, " + widen +
         " (share/doc/plvo/user/accuracy.md)";
}

}  // namespace

std::string doubt_about_scale(const Evaluation& e) {
  const AbsoluteError& ate = e.ate;
  if (!(ate.scale > 0) || std::abs(ate.scale - 1) <= kUsualScale ||
      ate.scaled_rmse_m > kExplained * ate.position_m.rmse ||
      kScaleSigmas * ate.scaled_rmse_m > std::abs(ate.scale - 1) * e.ate_identity.rmse)
    return {};
  return fmt::format(
      "the estimate's lengths are {:.3g} times the true ones (scaled by {:.3g} the ATE is {:.1f} mm, not "
      "{:.1f}): is "
      "the unit of depth right (depth_scale, --depth-scale), and the focal length?",
      1 / ate.scale, ate.scale, 1e3 * ate.scaled_rmse_m, 1e3 * ate.position_m.rmse);
}

std::vector<std::string> doubts_about(const Evaluation& e) {
  std::vector<std::string> sentences;
  if (std::string scale = doubt_about_scale(e); !scale.empty()) sentences.push_back(std::move(scale));
  // One sentence covers all of them: the one farthest off.
  const char* of = nullptr;
  double mean = 0, farthest = std::log(kFarNees);
  for (const auto& [name, nees] :
       {NamedNees{"of the poses", e.pose_nees}, NamedNees{"of the motions", e.motion_nees},
        NamedNees{"over a second", e.second_nees}}) {
    if (!nees || nees->count == 0 || !(nees->all.mean > 0)) continue;
    const double off = std::abs(std::log(nees->all.mean / nees->all.dof));
    if (off <= farthest) continue;
    farthest = off;
    mean = nees->all.mean;
    of = name;
  }
  if (of == nullptr) return sentences;
  const bool only_poses = !e.motion_nees && !e.second_nees;
  constexpr int kDof = 6;
  const double ratio = mean / kDof;
  const std::string advice =
      ratio > 1 ? advice_for_large_nees(e, ratio)
                : fmt::format(
                      "the covariance is larger than the errors, by {:.1f} in its standard deviations; if "
                      "--gt-sigma was given, it is too large",
                      1 / std::sqrt(ratio));
  sentences.push_back(fmt::format(
      "the NEES {} is {:.2f} in the mean, where a true covariance gives {}: {}{}", of, mean, kDof, advice,
      only_poses ? "; --est-motions judges more sharply, for neighbouring poses share their errors" : ""));
  return sentences;
}

}  // namespace plvo::eval
