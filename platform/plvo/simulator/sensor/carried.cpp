// SPDX-License-Identifier: Apache-2.0
#include "plvo/simulator/sensor/carried.hpp"

#include <algorithm>
#include <array>

#include "plvo/base/random.hpp"

namespace plvo::sim {
namespace {

constexpr double kBumperDepth_m = 0.55;  // beyond the shortest range of the depth sensor
constexpr float kDotStrength = 0.4F;     // share of white
// Digits of 3 × 5 cells, rows from the top, and a colon.
constexpr std::array<std::array<std::uint8_t, 5>, 11> kGlyphs = {{{7, 5, 5, 5, 7},
                                                                  {2, 6, 2, 2, 7},
                                                                  {7, 1, 7, 4, 7},
                                                                  {7, 1, 7, 1, 7},
                                                                  {5, 5, 7, 1, 1},
                                                                  {7, 4, 7, 1, 7},
                                                                  {7, 4, 7, 5, 7},
                                                                  {7, 1, 1, 1, 1},
                                                                  {7, 5, 7, 5, 7},
                                                                  {7, 5, 7, 1, 7},
                                                                  {0, 2, 0, 2, 0}}};

}  // namespace

Carried::Carried(const SimulatorOptions& options, Scene& scene)
    : width_(options.camera.width),
      height_(options.camera.height),
      clock_(options.difficulties.clock),
      bumper_top_(height_ - static_cast<int>(options.difficulties.bumper_share * height_ + 0.5)) {
  if (bumper_top_ < height_) make_bumper(options, scene);
  if (options.difficulties.dots_share > 0) make_dots(options);
}

void Carried::make_bumper(const SimulatorOptions& options, Scene& scene) {
  const CameraModel& camera = options.camera;
  scene.materials.push_back({.pattern = Pattern::kTiles,
                             .base = {0.15F, 0.14F, 0.1F},
                             .second = {0.02F, 0.02F, 0.02F},
                             .scale = 0.03F,
                             .contrast = 6});
  // No ray hits this solid. It tells the depth sensor the material.
  Solid bumper;
  bumper.material.fill(static_cast<std::uint16_t>(scene.materials.size() - 1));
  scene.solids.push_back(bumper);
  scene.first_thing = scene.solids.size();
  const int surface = static_cast<int>(scene.solids.size() - 1) * Solid::kFaces;
  const auto pixel_m = static_cast<float>(kBumperDepth_m / camera.pinhole.fx);
  const float size_u = pixel_m * static_cast<float>(width_);
  const float size_v = pixel_m * static_cast<float>(height_ - bumper_top_);
  for (int y = bumper_top_; y < height_; ++y) {
    for (int x = 0; x < width_; ++x) {
      bumper_.push_back({static_cast<float>(kBumperDepth_m), 0.95F, surface});
      const SurfaceSample sample{pixel_m * static_cast<float>(x),
                                 pixel_m * static_cast<float>(height_ - 1 - y),
                                 pixel_m,
                                 pixel_m,
                                 size_u,
                                 size_v,
                                 7};
      Rgb emitted;
      bumper_albedo_.push_back(shade_material(scene.materials.back(), sample, emitted));
    }
  }
}

// Each dot is a spot of 3 × 3 pixels, bright in the middle.
void Carried::make_dots(const SimulatorOptions& options) {
  dots_.resize(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_));
  Random random(options.seed, 0x444f);
  const auto count = static_cast<int>(options.difficulties.dots_share * width_ * height_);
  for (int k = 0; k < count; ++k) {
    const int cx = 1 + static_cast<int>(random.uniform() * (width_ - 2));
    const int cy = 1 + static_cast<int>(random.uniform() * (height_ - 2));
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        const float share = (dx == 0 ? 1.0F : 0.5F) * (dy == 0 ? 1.0F : 0.5F);
        float& dot = dots_[static_cast<std::size_t>((cy + dy) * width_ + cx + dx)];
        dot = std::max(dot, share * kDotStrength);
      }
    }
  }
}

ImageView<const PixelHit> Carried::cover(ImageView<const PixelHit> hits) {
  if (bumper_.empty()) return hits;
  hits_.assign(hits.data, hits.data + static_cast<std::ptrdiff_t>(width_) * height_);
  std::copy(bumper_.begin(), bumper_.end(),
            hits_.begin() + static_cast<std::ptrdiff_t>(width_) * bumper_top_);
  return {hits_.data(), width_, height_, width_};
}

void Carried::add_light(float irradiance, float level, std::vector<Rgb>& image) const {
  const std::size_t first = static_cast<std::size_t>(width_) * static_cast<std::size_t>(bumper_top_);
  for (std::size_t i = 0; i < bumper_albedo_.size(); ++i) image[first + i] = bumper_albedo_[i] * irradiance;
  for (std::size_t i = 0; i < dots_.size(); ++i) {
    const float dot = dots_[i] * level;
    image[i] = image[i] + Rgb{dot, dot, dot};
  }
}

void Carried::burn_in(double t_s, std::uint8_t* rgb) const {
  if (!clock_) return;
  const int cell = std::max(1, height_ / 120);
  const auto hundredths = static_cast<int>(t_s * 100 + 0.5);
  const int seconds = hundredths / 100;
  const std::array<int, 8> text = {seconds / 600 % 10,   seconds / 60 % 10, 10,
                                   seconds / 10 % 6,     seconds % 10,      10,
                                   hundredths / 10 % 10, hundredths % 10};
  const int columns = static_cast<int>(text.size()) * 4 + 1;
  for (int y = 0; y < std::min(7 * cell, height_); ++y) {
    for (int x = 0; x < std::min(columns * cell, width_); ++x) {
      const int column = x / cell - 1;
      const int row = y / cell - 1;
      bool lit = false;
      if (column >= 0 && row >= 0 && row < 5 && column % 4 < 3) {
        const int glyph = text[static_cast<std::size_t>(column / 4)];
        lit = (kGlyphs[static_cast<std::size_t>(glyph)][static_cast<std::size_t>(row)] >> (2 - column % 4) &
               1) != 0;
      }
      std::fill_n(rgb + 3 * (y * width_ + x), 3, lit ? std::uint8_t{255} : std::uint8_t{0});
    }
  }
}

}  // namespace plvo::sim
