// SPDX-License-Identifier: Apache-2.0
#include "plvo/simulator/sensor/film.hpp"

#include <algorithm>
#include <cmath>

#include "plvo/math/trigonometry.hpp"
#include "plvo/simulator/hash.hpp"
#include "plvo/simulator/parallel.hpp"

namespace plvo::sim {
namespace {

constexpr double kTargetMean = 0.19;  // linear level to which the mean of the scene is exposed (sRGB 121)
constexpr double kLag_s = 0.35;       // time constant of the exposure
constexpr double kBrightExposure_s = 0.008;
constexpr double kDarkExposure_s = 0.020;
constexpr double kExposureLevel = 0.35;  // mean radiance below which the exposure time starts to grow
constexpr double kDarkestLevel = 0.02;   // mean radiance below which the amplification stops growing
constexpr float kMeterClip =
    2.5F;  // times the current level; limits the influence of visible lamps on the exposure
constexpr float kReadNoise = 0.0014F;    // linear, at amplification 1
constexpr float kPhotonNoise = 0.0075F;  // times the square root of the linear value
constexpr int kCurveSize = 4096;
constexpr int kMaxTaps = 12;

Float3 transform(const Se3& T, Float3 p) {
  const Vector3 q = T * Vector3(static_cast<double>(p.x), static_cast<double>(p.y), static_cast<double>(p.z));
  return {static_cast<float>(q.x()), static_cast<float>(q.y()), static_cast<float>(q.z())};
}

// sRGB code of a linear value in [0, 1] by the definition, with x^(1/2.4) computed by exp and log.
std::uint8_t srgb(double linear) {
  const double coded =
      linear <= 0.0031308 ? 12.92 * linear : 1.055 * plvo::exp(plvo::log(linear) / 2.4) - 0.055;
  return static_cast<std::uint8_t>(std::clamp(coded * 255 + 0.5, 0.0, 255.0));
}

}  // namespace

Film::Film(const CameraModel& camera, std::uint64_t seed, bool noise, int threads)
    : camera_(camera), seed_(sensor_seed(seed, 0x46U)), noise_(noise), threads_(threads) {
  const auto pixels = static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height);
  blurred_.resize(pixels);
  pixels_.resize(3 * pixels);
  row_sums_.resize(static_cast<std::size_t>(camera.height));
  // The table is indexed by the square root of the linear value, which gives enough resolution at the dark
  // end.
  for (int i = 0; i < kCurveSize; ++i) {
    const double root = i / (kCurveSize - 1.0);
    curve_.push_back(srgb(root * root));
  }
}

// Mean of the clipped luminance. Sums each row first, then the rows in order, so the result does not depend
// on the threads.
void Film::meter(ImageView<const Rgb> radiance) {
  const float clip = metered_ ? kMeterClip * static_cast<float>(level_) : 4.0F;
  for_rows(threads_, radiance.height, kThreadRows, [&](int begin, int end) {
    for (int y = begin; y < end; ++y) {
      double sum = 0;
      for (int x = 0; x < radiance.width; ++x)
        sum += static_cast<double>(std::min(luminance(radiance.at(x, y)), clip));
      row_sums_[static_cast<std::size_t>(y)] = sum;
    }
  });
  double total = 0;
  for (const double sum : row_sums_) total += sum;
  measured_ = std::max(total / radiance.width / radiance.height, 1e-6);
}

void Film::blur_rows(Renderer& renderer, const Se3& T_mid_begin, const Se3& T_mid_end, int begin, int end) {
  const ImageView<Rgb> radiance = renderer.radiance();
  const ImageView<const PixelHit> hits = renderer.hits();
  const ImageView<const Float3> rays = renderer.rays();
  const Scene& scene = renderer.scene();
  const Se3 T_begin_mid = T_mid_begin.inverse();
  const Se3 T_end_mid = T_mid_end.inverse();
  const auto fx = static_cast<float>(camera_.pinhole.fx);
  const auto fy = static_cast<float>(camera_.pinhole.fy);
  for (int y = begin; y < end; ++y) {
    for (int x = 0; x < radiance.width; ++x) {
      Rgb& out = blurred_[static_cast<std::size_t>(y * radiance.width + x)];
      const float depth = hits.at(x, y).depth_m > 0 ? hits.at(x, y).depth_m : 1e3F;
      const Float3 p = rays.at(x, y) * depth;
      Float3 opening = p;
      Float3 closing = p;
      if (const int solid = hits.at(x, y).surface / Solid::kFaces;
          hits.at(x, y).surface >= 0 && scene.is_thing(solid)) {
        const RowView& view = renderer.view(y);
        const Float3 point = view.origin + view.to_world(p);
        const Float3 local = scene.solids[static_cast<std::size_t>(solid)].to_local(point);
        const std::size_t thing = static_cast<std::size_t>(solid) - scene.first_thing;
        opening = p + view.to_camera(scene.things_opening[thing].to_world(local) - point);
        closing = p + view.to_camera(scene.things_closing[thing].to_world(local) - point);
      }
      const Float3 a = transform(T_begin_mid, opening);
      const Float3 b = transform(T_end_mid, closing);
      if (a.z < 0.05F || b.z < 0.05F) {
        out = radiance.at(x, y);
        continue;
      }
      // The path of the point over the image from the beginning to the end of the exposure, relative to this
      // pixel. The points that pass this pixel during the exposure lie on the opposite path.
      const float move_x = fx * (b.x / b.z - a.x / a.z);
      const float move_y = fy * (b.y / b.z - a.y / a.z);
      const float length = std::max(std::abs(move_x), std::abs(move_y));
      const int taps = std::min(static_cast<int>(length * 1.5F) + 1, kMaxTaps);
      Rgb sum;
      for (int k = 0; k < taps; ++k) {
        const float s = (static_cast<float>(k) + 0.5F) / static_cast<float>(taps) - 0.5F;
        const float px =
            std::clamp(static_cast<float>(x) + s * move_x, 0.0F, static_cast<float>(radiance.width - 1));
        const float py =
            std::clamp(static_cast<float>(y) + s * move_y, 0.0F, static_cast<float>(radiance.height - 1));
        const int ix = std::min(static_cast<int>(px), radiance.width - 2);
        const int iy = std::min(static_cast<int>(py), radiance.height - 2);
        const float u = px - static_cast<float>(ix);
        const float v = py - static_cast<float>(iy);
        const Rgb* top = radiance.row(iy) + ix;
        const Rgb* bottom = radiance.row(iy + 1) + ix;
        sum = sum + mix(mix(top[0], top[1], u), mix(bottom[0], bottom[1], u), v);
      }
      out = sum * (1.0F / static_cast<float>(taps));
    }
  }
}

void Film::expose_rows(std::uint32_t frame, int begin, int end) {
  const float gain = static_cast<float>(kTargetMean / level_);
  const std::uint32_t frame_seed = hash(frame, seed_);
  const float read = kReadNoise * amplification_;
  const float photon = kPhotonNoise * std::sqrt(amplification_);
  for (int y = begin; y < end; ++y) {
    std::uint8_t* out =
        pixels_.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(camera_.width) * 3;
    const std::uint32_t row_seed = hash(static_cast<std::uint32_t>(y) + frame_seed);
    for (int x = 0; x < camera_.width; ++x) {
      Rgb value = blurred_[static_cast<std::size_t>(y * camera_.width + x)] * gain;
      if (noise_) {
        // Each channel has its own noise. Because of demosaicing, half of the green pixels contribute to all
        // three channels.
        const std::uint32_t h = hash(static_cast<std::uint32_t>(x) + row_seed);
        const std::uint32_t h2 = hash(h ^ 0x68bc21ebU);
        const std::uint32_t h3 = hash(h ^ 0x02e5be93U);
        const float shared = gaussian(h, h2);
        const float red = gaussian(h2, h3);
        const float blue = gaussian(h3, h);
        const float sigma = read + photon * std::sqrt(std::max(0.0F, luminance(value)));
        value = value + Rgb{0.6F * shared + 0.8F * red, shared, 0.6F * shared + 0.9F * blue} * sigma;
      }
      for (int channel = 0; channel < 3; ++channel) {
        const float root = std::sqrt(clamp01(value[channel]));
        *out++ = curve_[static_cast<std::size_t>(root * (kCurveSize - 1) + 0.5F)];
      }
    }
  }
}

void Film::blur(Renderer& renderer, const Se3& T_mid_begin, const Se3& T_mid_end) {
  meter(renderer.radiance());
  if (!metered_) {  // the camera was already running before the first frame
    level_ = measured_;
    metered_ = true;
  }
  const double level = std::max(level_, kDarkestLevel);
  level_ = level;
  amplification_ =
      static_cast<float>(std::max(1.0, kExposureLevel / level * kBrightExposure_s / exposure_s_));
  const ImageView<Rgb> radiance = renderer.radiance();
  if (noise_) {
    for_rows(threads_, radiance.height, kThreadRows,
             [&](int a, int b) { blur_rows(renderer, T_mid_begin, T_mid_end, a, b); });
  } else {
    std::copy(radiance.data, radiance.data + blurred_.size(), blurred_.begin());
  }
}

double Film::white() const { return level_ / kTargetMean; }

void Film::expose(std::uint32_t frame, double frame_s) {
  for_rows(threads_, camera_.height, kThreadRows, [&](int a, int b) { expose_rows(frame, a, b); });

  level_ += (measured_ - level_) * (1 - plvo::exp(-frame_s / kLag_s));
  exposure_s_ = std::clamp(kBrightExposure_s * kExposureLevel / level_, kBrightExposure_s, kDarkExposure_s);
}

}  // namespace plvo::sim
