// SPDX-License-Identifier: Apache-2.0
// How far the ground truth of a recording is off itself, from estimates that err independently of each other.
// docs/sensors.md shows what it said.
//   truth_noise GROUNDTRUTH TRAJECTORY TRAJECTORY…   a Markdown table of every pair on standard output
#include <fmt/core.h>

#include <filesystem>
#include <string>
#include <vector>

#include "plvo/eval/truth_noise.hpp"
#include "plvo/math/trigonometry.hpp"

namespace plvo::bench {
namespace {

int fail(const std::string& why) {
  fmt::print(stderr, "truth_noise: {}\n", why);
  return 1;
}

int study(const std::vector<std::string>& files) {
  std::vector<eval::Trajectory> trajectories(files.size());
  for (std::size_t i = 0; i < files.size(); ++i)
    if (const Status status = read_trajectory({files[i], {}, {}}, trajectories[i]); !status.ok())
      return fail(std::string(status.message()));
  fmt::print(
      "| first | second | motions | RMSE of the first: mm, deg | of the second | the truth's, a pose and "
      "axis |\n"
      "|---|---|---:|---:|---:|---:|\n");
  const double degree = kPi / 180;
  for (std::size_t a = 1; a < files.size(); ++a) {
    for (std::size_t b = a + 1; b < files.size(); ++b) {
      const eval::TruthNoise noise = eval::truth_noise(trajectories[0], trajectories[a], trajectories[b], {});
      if (noise.motions == 0)
        return fail(files[a] + " and " + files[b] + " have no motion with ground truth in common");
      const auto name = [&](std::size_t i) { return std::filesystem::path(files[i]).stem().string(); };
      fmt::print("| {} | {} | {} | {:.2f}, {:.3f} | {:.2f}, {:.3f} | {:.2f} mm, {:.3f} deg |\n", name(a),
                 name(b), noise.motions, 1e3 * noise.first_m, noise.first_rad / degree, 1e3 * noise.second_m,
                 noise.second_rad / degree, 1e3 * noise.sigma.position_m,
                 noise.sigma.orientation_rad / degree);
    }
  }
  return 0;
}

}  // namespace
}  // namespace plvo::bench

int main(int argc, char** argv) {
  if (argc < 4) {
    fmt::print(stderr, "usage: truth_noise GROUNDTRUTH TRAJECTORY TRAJECTORY...\n");
    return 2;
  }
  return plvo::bench::study({argv + 1, argv + argc});
}
