// SPDX-License-Identifier: Apache-2.0
#include "plvo/simulator/sensor/kinect_depth.hpp"

#include <algorithm>
#include <cmath>

#include "plvo/simulator/hash.hpp"
#include "plvo/simulator/parallel.hpp"

namespace plvo::sim {
namespace {

// The correlation window correlates neighbouring errors; half of the variance has this correlation length.
constexpr float kPatch_px = 3;
constexpr float kValueNoiseSigma = 0.4289F;  // standard deviation of value_noise() over the plane
constexpr float kEdgeShift_px = 1.3F;        // displacement of the outline of a near object
constexpr float kSignalFloor = 0.0085F;      // returned light below which the pattern is not found
constexpr float kSignalSpread = 0.35F;       // variation of kSignalFloor between patches
constexpr float kGrazing = 0.10F;  // cosine below which the pattern is too stretched to be recognised

std::uint16_t to_units(float depth_m) {
  const float units = depth_m * static_cast<float>(1 / kMetresPerUnit) + 0.5F;
  return units < 65535.5F ? static_cast<std::uint16_t>(units) : std::uint16_t{0};
}

// Share of the projector's light that returns to the infrared camera, relative to a white matt wall at 1 m.
float returned_light(const Material& material, float cosine, float depth_m) {
  float grazing = 1 - cosine;
  grazing *= grazing * grazing;
  const float diffuse = material.infrared * (1 - material.gloss * (0.35F + 0.6F * grazing));
  return diffuse * cosine / (depth_m * depth_m);
}

}  // namespace

KinectDepth::KinectDepth(const Scene& scene, const CameraModel& camera, const DepthSensorOptions& options,
                         std::uint64_t seed, int threads)
    : scene_(scene),
      options_(options),
      seed_(sensor_seed(seed, 0x44U)),
      width_(camera.width),
      height_(camera.height),
      threads_(threads),
      colour_to_infrared_(static_cast<float>(options.focal_px / camera.pinhole.fx)) {
  depth_.resize(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_));
}

DepthView KinectDepth::view() const { return {depth_.data(), width_, height_, width_, kMetresPerUnit}; }

void KinectDepth::comb() {
  for (int y = 0; y < height_; ++y) {
    for (int x = 0; x < width_; ++x) {
      if (y % 2 == 0 || x % 2 == 0) depth_[static_cast<std::size_t>(y * width_ + x)] = 0;
    }
  }
}

void KinectDepth::copy_exact(ImageView<const PixelHit> hits) {
  const auto scale = static_cast<float>(options_.scale_error);
  for (int y = 0; y < height_; ++y) {
    for (int x = 0; x < width_; ++x)
      depth_[static_cast<std::size_t>(y * width_ + x)] = to_units(scale * hits.at(x, y).depth_m);
  }
}

void KinectDepth::sense(ImageView<const PixelHit> hits, std::uint32_t frame) {
  const std::uint32_t frame_seed = hash(frame, seed_);
  for_rows(threads_, height_, kThreadRows, [&](int begin, int end) {
    for (int y = begin; y < end; ++y) sense_row(hits, frame_seed, y);
  });
}

void KinectDepth::sense_row(ImageView<const PixelHit> hits, std::uint32_t frame_seed, int y) {
  const auto focal_baseline = static_cast<float>(options_.focal_px * options_.baseline_m);
  const auto steps = static_cast<float>(options_.steps_per_px);
  const auto min_range = static_cast<float>(options_.min_range_m);
  const auto max_range = static_cast<float>(options_.max_range_m);
  const auto scale = static_cast<float>(options_.scale_error);
  const std::uint32_t row_seed = hash(static_cast<std::uint32_t>(y) + frame_seed);
  const auto fy = static_cast<float>(y);
  // From the projector, which is on the right, near objects hide what lies to their left. From right to left
  // the column in the projector's image must therefore decrease monotonically.
  float leftmost = 1e30F;
  for (int x = width_ - 1; x >= 0; --x) {
    std::uint16_t& out = depth_[static_cast<std::size_t>(y * width_ + x)];
    out = 0;
    const PixelHit& here = hits.at(x, y);
    if (here.surface < 0) continue;
    const float column = static_cast<float>(x) * colour_to_infrared_ - focal_baseline / here.depth_m;
    const bool hidden = column > leftmost + 0.5F;
    leftmost = std::min(leftmost, column);
    if (hidden) continue;

    // The outline of a near object is noisy: at a depth step the pixel may report the depth of its neighbour.
    const auto fx = static_cast<float>(x);
    PixelHit pixel = here;
    const float shift_x = 2 * kEdgeShift_px * value_noise(fx * 0.25F, fy * 0.25F, frame_seed + 1);
    const float shift_y = 2 * kEdgeShift_px * value_noise(fx * 0.25F, fy * 0.25F, frame_seed + 2);
    const int sx = std::clamp(static_cast<int>(fx + shift_x + 0.5F), 0, width_ - 1);
    const int sy = std::clamp(static_cast<int>(fy + shift_y + 0.5F), 0, height_ - 1);
    const PixelHit& neighbour = hits.at(sx, sy);
    if (neighbour.surface >= 0 && std::abs(neighbour.depth_m - here.depth_m) > 0.04F * here.depth_m)
      pixel = neighbour;

    const float z = pixel.depth_m;
    if (z < min_range || z > max_range) continue;
    const Material& material = scene_.material(pixel.surface);
    const float patch = value_noise(fx * 0.14F, fy * 0.14F, frame_seed + 3) +
                        0.6F * value_noise(fx * 0.45F, fy * 0.45F, frame_seed + 4);
    if (returned_light(material, pixel.cosine, z) < kSignalFloor * (1 + kSignalSpread * patch)) continue;
    if (pixel.cosine < kGrazing * (1 + 0.5F * patch)) continue;
    // A polished surface that faces the sensor reflects the projector's image directly and saturates the
    // camera.
    if (material.gloss > 0.5F && pixel.cosine > 0.9985F - 0.001F * patch) continue;

    // Chooses the noise such that noise and rounding together have the requested standard deviation.
    const float target =
        static_cast<float>(options_.noise_scale * options_.noise.sigma(static_cast<double>(z)));
    const float step_m = steps > 0 ? z * z / (focal_baseline * steps) : 0;
    const float sigma = std::sqrt(std::max(0.0F, target * target - step_m * step_m / 12));
    const std::uint32_t h = hash(static_cast<std::uint32_t>(x) + row_seed);
    const float alike =
        value_noise(fx / kPatch_px + 0.37F, fy / kPatch_px + 0.71F, frame_seed + 5) / kValueNoiseSigma;
    const float error_m = sigma * 0.70710678F * (gaussian(h) + alike);
    float disparity = focal_baseline / z - error_m * focal_baseline / (z * z);
    if (steps > 0) disparity = std::floor(disparity * steps + 0.5F) / steps;
    if (disparity <= 0) continue;
    const float measured = focal_baseline / disparity;
    if (measured < min_range || measured > max_range) continue;
    out = to_units(scale * measured);
  }
}

}  // namespace plvo::sim
