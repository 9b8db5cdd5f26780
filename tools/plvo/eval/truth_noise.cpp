// SPDX-License-Identifier: Apache-2.0
#include "plvo/eval/truth_noise.hpp"

#include <algorithm>
#include <cmath>

namespace plvo::eval {
namespace {

// Where two estimates have a pose at the same stamp.
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

double rms(double sum_of_squares, double count) { return std::sqrt(sum_of_squares / count); }

// Of a pose in each axis, when `product` sums e_aᵀ e_b over motions, which have two poses and three axes.
double sigma_of(double product, double motions) {
  return std::sqrt(std::max(0.0, product / motions) / (2 * 3));
}

}  // namespace

TruthNoise truth_noise(const Trajectory& ground_truth, const Trajectory& first, const Trajectory& second,
                       const TruthSampling& sampling) {
  const CommonPoses common = common_poses(first, second);
  const SampledPoses truth = sample(ground_truth, common.stamps_ns, sampling);
  TruthNoise noise;
  Vector2 squares_a = Vector2::Zero(), squares_b = Vector2::Zero(), product = Vector2::Zero();
  for (std::size_t i = 1; i < common.stamps_ns.size(); ++i) {
    if (!truth.valid[i - 1] || !truth.valid[i]) continue;
    const Se3 motion = truth.poses[i].inverse() * truth.poses[i - 1];
    const Vector6 a = boxminus(common.first[i].inverse() * common.first[i - 1], motion);
    const Vector6 b = boxminus(common.second[i].inverse() * common.second[i - 1], motion);
    const auto parts = [](const Vector6& u, const Vector6& v) {
      return Vector2(u.head<3>().dot(v.head<3>()), u.tail<3>().dot(v.tail<3>()));
    };
    squares_a += parts(a, a);
    squares_b += parts(b, b);
    product += parts(a, b);
    ++noise.motions;
  }
  if (noise.motions == 0) return noise;
  const auto n = static_cast<double>(noise.motions);
  noise.first_m = rms(squares_a[0], n);
  noise.first_rad = rms(squares_a[1], n);
  noise.second_m = rms(squares_b[0], n);
  noise.second_rad = rms(squares_b[1], n);
  noise.sigma = {sigma_of(product[0], n), sigma_of(product[1], n)};
  return noise;
}

}  // namespace plvo::eval
