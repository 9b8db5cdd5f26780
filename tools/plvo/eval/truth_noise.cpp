// SPDX-License-Identifier: Apache-2.0
#include "plvo/eval/truth_noise.hpp"

#include <algorithm>
#include <cmath>

namespace plvo::eval {
namespace {

// The poses of two estimates at their common stamps.
struct CommonPoses {
  std::vector<std::int64_t> stamps_ns;
  std::vector<Se3> first, second;
};

CommonPoses common_poses(const Trajectory& first, const Trajectory& second) {
  CommonPoses common;
  auto b = second.poses.begin();
  for (const StampedPose& a : first.poses) {
    while (b != second.poses.end() && b->stamp_ns < a.stamp_ns) ++b;
    if (b == second.poses.end()) break;
    if (b->stamp_ns != a.stamp_ns) continue;
    common.stamps_ns.push_back(a.stamp_ns);
    common.first.push_back(a.T_world_camera);
    common.second.push_back(b->T_world_camera);
  }
  return common;
}

Vector2 products(const Vector6& a, const Vector6& b) {
  return {a.head<3>().dot(b.head<3>()), a.tail<3>().dot(b.tail<3>())};
}

double rms(double sum_of_squares, double count) { return std::sqrt(sum_of_squares / count); }

// Returns the standard deviation of a pose in each axis, from the sum of e_aᵀ e_b over motions; a motion has
// two poses and three axes.
double sigma_of(double product, double motions) {
  return std::sqrt(std::max(0.0, product / motions) / (2 * 3));
}

}  // namespace

void CommonErrors::add(const Vector6& first, const Vector6& second) {
  first_squares_ += products(first, first);
  second_squares_ += products(second, second);
  products_ += products(first, second);
  ++motions_;
}

TruthNoise CommonErrors::noise() const {
  if (motions_ == 0) return {};
  const auto n = static_cast<double>(motions_);
  return {motions_,
          rms(first_squares_[0], n),
          rms(first_squares_[1], n),
          rms(second_squares_[0], n),
          rms(second_squares_[1], n),
          {sigma_of(products_[0], n), sigma_of(products_[1], n)}};
}

TruthNoise truth_noise(const Trajectory& ground_truth, const Trajectory& first, const Trajectory& second,
                       const TruthSampling& sampling) {
  const CommonPoses common = common_poses(first, second);
  const SampledPoses truth = sample(ground_truth, common.stamps_ns, sampling);
  CommonErrors errors;
  for (std::size_t i = 1; i < common.stamps_ns.size(); ++i) {
    if (!truth.valid[i - 1] || !truth.valid[i]) continue;
    const Se3 motion = truth.poses[i].inverse() * truth.poses[i - 1];
    errors.add(boxminus(common.first[i].inverse() * common.first[i - 1], motion),
               boxminus(common.second[i].inverse() * common.second[i - 1], motion));
  }
  return errors.noise();
}

}  // namespace plvo::eval
