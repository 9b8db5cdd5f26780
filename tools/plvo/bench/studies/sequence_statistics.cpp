// SPDX-License-Identifier: Apache-2.0
// Compares the data of sequences, recorded or simulated, with the same estimator for both: the residual of
// each frame warped into the next one by the true pose, the noise of depth relative to planes, holes, the
// noise of grey values, and the drift of brightness. docs/decisions/simulator_realism.md shows the results.
//   sequence_statistics DIR…        TUM folders with calibration.txt and groundtruth.txt; a Markdown table on
//   standard output
#include <fmt/core.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "plvo/bench/systems/ideal_images.hpp"
#include "plvo/bench/table.hpp"
#include "plvo/camera/depth_noise.hpp"
#include "plvo/eval/statistics.hpp"
#include "plvo/eval/trajectory.hpp"
#include "plvo/replay/calibration/calibration.hpp"
#include "plvo/replay/recorded_camera.hpp"

namespace plvo::bench {
namespace {

constexpr int kEvery = 5;            // evaluates every fifth frame
constexpr std::size_t kFewest = 10;  // windows that a distance needs for a result
constexpr int kWindow = 16;          // px, side of the windows that planes are fitted to
constexpr std::array<std::array<double, 2>, 6> kDepthBins_m = {
    {{0.7, 1.0}, {1.3, 1.6}, {1.6, 2.0}, {2.0, 2.5}, {2.5, 3.0}, {3.0, 3.5}}};

struct Picture {
  int width = 0, height = 0;
  std::vector<double> gray, smooth;  // smooth: two passes of the binomial filter (1 2 1)/4 along each axis
  std::vector<double> depth_m;       // 0: no depth
  Se3 T_world_camera;
  std::size_t at(int x, int y) const { return static_cast<std::size_t>(y * width + x); }
};

struct Samples {
  std::vector<double> warp_gray, warp_depth, still_gray, still_depth;
  std::array<std::vector<double>, kDepthBins_m.size()> plane_mm;
  std::vector<double> holes, gray_noise, brightness_step;
};

Picture make_picture(IdealImages& images, const RgbdFrame& frame) {
  images.make(frame);
  Picture p{images.width(), images.height(), {}, {}, {}, {}};
  const auto pixels = static_cast<std::size_t>(p.width * p.height);
  for (std::size_t i = 0; i < pixels; ++i) {
    const std::uint8_t* rgb = images.rgb() + 3 * i;
    p.gray.push_back(0.299 * rgb[0] + 0.587 * rgb[1] + 0.114 * rgb[2]);
    p.depth_m.push_back(images.depth()[i] * frame.depth.metres_per_unit);
  }
  p.smooth = p.gray;
  const auto row = static_cast<std::size_t>(p.width);
  for (const std::size_t step : {std::size_t{1}, row, std::size_t{1}, row}) {
    const std::vector<double> in = p.smooth;
    for (std::size_t i = step; i + step < pixels; ++i)
      p.smooth[i] = 0.25 * (in[i - step] + 2 * in[i] + in[i + step]);
  }
  return p;
}

// Differences of grey values and depths between `from`, moved by T_to_from, and `to` at the corresponding
// pixel. Pixels at a depth discontinuity or on a hidden surface are skipped.
void warp(const Pinhole& pinhole, const Picture& from, const Picture& to, const Se3& T_to_from,
          std::vector<double>& gray, std::vector<double>& depth) {
  constexpr double kSameSurface = 0.05;
  for (int y = 2; y < from.height - 2; y += 2) {
    for (int x = 2; x < from.width - 2; x += 2) {
      const double d = from.depth_m[from.at(x, y)];
      if (d <= 0) continue;
      const Vector3 p = T_to_from * back_project(pinhole, x, y, d);
      if (p.z() < 0.1) continue;
      const Vector2 q = project(pinhole, p);
      if (!(q.x() >= 1 && q.y() >= 1 && q.x() < to.width - 2 && q.y() < to.height - 2)) continue;
      const int qx = static_cast<int>(q.x());
      const int qy = static_cast<int>(q.y());
      const double u = q.x() - qx;
      const double v = q.y() - qy;
      const double seen = to.depth_m[to.at(qx + (u >= 0.5 ? 1 : 0), qy + (v >= 0.5 ? 1 : 0))];
      if (seen <= 0 || std::abs(seen - p.z()) > kSameSurface * p.z()) continue;
      const auto value = [&](int i, int j) { return to.smooth[to.at(qx + i, qy + j)]; };
      const double there =
          (1 - v) * ((1 - u) * value(0, 0) + u * value(1, 0)) + v * ((1 - u) * value(0, 1) + u * value(1, 1));
      gray.push_back(std::abs(there - from.smooth[from.at(x, y)]));
      depth.push_back(100 * std::abs(seen - p.z()) / p.z());
    }
  }
}

// Mean depth and residual of a plane fit; inverse depth of a plane is linear over the image. Returns nullopt
// if depth is missing or the window contains a step.
std::optional<std::array<double, 2>> plane_residual(const Picture& p, int x0, int y0) {
  constexpr int kCount = kWindow * kWindow;
  Eigen::Matrix<double, kCount, 3> A;
  Eigen::Matrix<double, kCount, 1> b;
  double low = 1e9, high = 0;
  for (int k = 0; k < kCount; ++k) {
    const int x = x0 + k % kWindow;
    const int y = y0 + k / kWindow;
    const double d = p.depth_m[p.at(x, y)];
    if (d <= 0) return std::nullopt;
    low = std::min(low, d);
    high = std::max(high, d);
    A.row(k) << 1, x - x0, y - y0;
    b(k) = 1 / d;
  }
  if (high > 1.15 * low) return std::nullopt;
  const Eigen::Vector3d plane = (A.transpose() * A).ldlt().solve(A.transpose() * b);
  const double rms = std::sqrt((A * plane - b).squaredNorm() / (kCount - 3));
  const double z = kCount / b.sum();
  return std::array<double, 2>{z, rms * z * z};
}

// Noise of a window by Immerkaer's mask (CVIU 1996), which does not respond to a slope or to an edge along an
// axis.
double gray_noise(const Picture& p, int x0, int y0) {
  double sum = 0;
  for (int y = y0 + 1; y < y0 + kWindow - 1; ++y) {
    for (int x = x0 + 1; x < x0 + kWindow - 1; ++x) {
      const auto g = [&](int i, int j) { return p.gray[p.at(x + i, y + j)]; };
      sum += std::abs(g(-1, -1) - 2 * g(0, -1) + g(1, -1) - 2 * g(-1, 0) + 4 * g(0, 0) - 2 * g(1, 0) +
                      g(-1, 1) - 2 * g(0, 1) + g(1, 1));
    }
  }
  constexpr double kPi = 3.14159265358979;
  return std::sqrt(kPi / 2) * sum / (6.0 * (kWindow - 2) * (kWindow - 2));
}

void look_at_windows(const Picture& p, Samples& samples) {
  std::vector<double> noises;
  for (int y = kWindow; y + 2 * kWindow <= p.height; y += kWindow) {
    for (int x = kWindow; x + 2 * kWindow <= p.width; x += kWindow) {
      const double brightness = p.smooth[p.at(x + kWindow / 2, y + kWindow / 2)];
      if (brightness > 30 && brightness < 225) noises.push_back(gray_noise(p, x, y));
      const auto residual = plane_residual(p, x, y);
      if (!residual) continue;
      for (std::size_t bin = 0; bin < kDepthBins_m.size(); ++bin)
        if ((*residual)[0] >= kDepthBins_m[bin][0] && (*residual)[0] < kDepthBins_m[bin][1])
          samples.plane_mm[bin].push_back(1e3 * (*residual)[1]);
    }
  }
  // The tenth of the windows with the least noise has the least texture.
  std::sort(noises.begin(), noises.end());
  if (!noises.empty()) samples.gray_noise.push_back(eval::quantile(noises, 0.1));
  const auto none = std::count(p.depth_m.begin(), p.depth_m.end(), 0.0);
  samples.holes.push_back(100.0 * static_cast<double>(none) / static_cast<double>(p.depth_m.size()));
}

Status collect(const std::string& folder, Samples& samples) {
  Calibration calibration;
  if (Status status = read_calibration(std::filesystem::path(folder) / "calibration.txt", calibration);
      !status.ok())
    return status;
  RecordedCamera camera;
  if (Status status = camera.open(folder, calibration); !status.ok()) return status;
  eval::Trajectory truth;
  if (Status status =
          eval::read_trajectory({std::filesystem::path(folder) / "groundtruth.txt", {}, {}}, truth);
      !status.ok())
    return status;
  IdealImages images(camera.model());
  const Pinhole pinhole = camera.model().pinhole;
  Picture before;
  double brightness_before = -1;
  RgbdFrame frame;
  for (int number = 0;; ++number) {
    const Status status = camera.next(frame);
    if (status.code() == StatusCode::kEndOfStream) return {};
    if (!status.ok()) return status;
    const Picture picture = [&] {
      Picture p = make_picture(images, frame);
      const eval::SampledPoses pose = eval::sample(truth, {frame.stamp_ns}, {});
      if (pose.valid[0]) p.T_world_camera = pose.poses[0];
      return p;
    }();
    double brightness = 0;
    for (const double g : picture.gray) brightness += g / static_cast<double>(picture.gray.size());
    if (brightness_before >= 0)
      samples.brightness_step.push_back(100 * std::abs(brightness / brightness_before - 1));
    brightness_before = brightness;
    if (number % kEvery == 1) {
      const Se3 T_now_before = picture.T_world_camera.inverse() * before.T_world_camera;
      warp(pinhole, before, picture, T_now_before, samples.warp_gray, samples.warp_depth);
      warp(pinhole, before, picture, Se3(), samples.still_gray, samples.still_depth);
      look_at_windows(picture, samples);
    }
    before = picture;
  }
}

std::string quantile_of(std::vector<double> values, double q, int decimals) {
  if (values.empty()) return "–";
  std::sort(values.begin(), values.end());
  return cell(eval::quantile(values, q), decimals);
}

int print_table(const std::vector<std::string>& names, const std::vector<Samples>& all) {
  Table table;
  table.header = {""};
  table.header.insert(table.header.end(), names.begin(), names.end());
  table.text_columns = 1;
  const auto add = [&](const std::string& name, auto value) {
    std::vector<std::string> row = {name};
    for (const Samples& samples : all) row.push_back(value(samples));
    table.rows.push_back(row);
  };
  add("warped by the true pose: grey levels, median",
      [](const Samples& s) { return quantile_of(s.warp_gray, 0.5, 2); });
  add("… not warped", [](const Samples& s) { return quantile_of(s.still_gray, 0.5, 2); });
  add("warped by the true pose: grey levels, 90 %",
      [](const Samples& s) { return quantile_of(s.warp_gray, 0.9, 2); });
  add("… not warped", [](const Samples& s) { return quantile_of(s.still_gray, 0.9, 2); });
  add("warped by the true pose: depth, median, % of it",
      [](const Samples& s) { return quantile_of(s.warp_depth, 0.5, 2); });
  add("… not warped", [](const Samples& s) { return quantile_of(s.still_depth, 0.5, 2); });
  for (std::size_t bin = 0; bin < kDepthBins_m.size(); ++bin) {
    const auto [low, high] = kDepthBins_m[bin];
    const double formula_mm = 1e3 * DepthNoise().sigma(0.5 * (low + high));
    add(fmt::format("residual of planes at {:g}–{:g} m, mm (formula (2): {:.1f})", low, high, formula_mm),
        [bin](const Samples& s) {
          const std::vector<double>& mm = s.plane_mm[bin];
          return mm.size() < kFewest ? std::string("–") : quantile_of(mm, 0.5, 1);
        });
  }
  add("pixels without depth, %, median", [](const Samples& s) { return quantile_of(s.holes, 0.5, 1); });
  add("noise of grey levels", [](const Samples& s) { return quantile_of(s.gray_noise, 0.5, 2); });
  add("change of brightness per frame, %, median",
      [](const Samples& s) { return quantile_of(s.brightness_step, 0.5, 2); });
  add("change of brightness per frame, %, 90 %",
      [](const Samples& s) { return quantile_of(s.brightness_step, 0.9, 2); });
  fmt::print("{}", to_markdown(table));
  return 0;
}

}  // namespace
}  // namespace plvo::bench

int main(int argc, char** argv) {
  std::vector<std::string> names;
  std::vector<plvo::bench::Samples> all;
  for (int i = 1; i < argc; ++i) {
    all.emplace_back();
    names.push_back(std::filesystem::absolute(argv[i]).lexically_normal().filename().string());
    const plvo::Status status = plvo::bench::collect(argv[i], all.back());
    if (!status.ok()) {
      fmt::print(stderr, "sequence_statistics: error: {}\n", status.message());
      return 1;
    }
  }
  if (all.empty()) {
    fmt::print(stderr, "usage: sequence_statistics DIR…   (TUM folders with groundtruth.txt)\n");
    return 2;
  }
  return plvo::bench::print_table(names, all);
}
