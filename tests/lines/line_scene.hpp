// SPDX-License-Identifier: Apache-2.0
// Random 3D lines in front of a camera, their segments, and their samples with the noise that (3) assumes.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>

#include "plvo/base/random.hpp"
#include "plvo/lines/line3d.hpp"

namespace plvo::test {

inline constexpr std::uint64_t kSeed = 1;  // seed of the fits

inline double gaussian(Random& random) {
  double sum = 0;
  for (int i = 0; i < 12; ++i) sum += random.uniform();
  return sum - 6;
}

inline Segment random_segment(Random& random, double shortest_px, double longest_px) {
  for (;;) {
    Segment s;
    s.a = {640 * random.uniform(), 480 * random.uniform()};
    s.b = {640 * random.uniform(), 480 * random.uniform()};
    if (s.length_px() > shortest_px && s.length_px() < longest_px) return s;
  }
}

inline double offset_from_line(const Vector3& p, const Vector3& a, const Vector3& b) {
  const Vector3 d = (b - a).normalized();
  return (p - a - d * d.dot(p - a)).norm();
}

// A depth image computed by a function of the pixel.
template <typename Function>
struct DepthFunction {
  Function function;
  class Stretch {
   public:
    Stretch(const DepthFunction& depth, const Vector2& first, const Vector2& step, int, const Vector2& across,
            int)
        : depth_(depth), first_(first), step_(step), across_(across) {}
    bool go_to(int i) {
      place_ = first_ + i * step_;
      return true;
    }
    double at(int times) const {
      const Vector2 p = place_ + times * across_;
      return depth_.function(static_cast<int>(std::floor(p.x() + 0.5)),
                             static_cast<int>(std::floor(p.y() + 0.5)));
    }
    DepthSample between() const { return {}; }
    double at_colour_time(double depth_m) const { return depth_m; }

   private:
    const DepthFunction& depth_;
    Vector2 first_, step_, across_, place_;
  };
};
template <typename Function>
DepthFunction(Function) -> DepthFunction<Function>;

struct LineScene {
  Segment segment;
  Vector3 a, b;  // points of the true line at the ends of the segment

  static LineScene random(Random& random, const Pinhole& pinhole) {
    LineScene scene;
    scene.segment = random_segment(random, 60, 300);
    const double depth = 1 + 2 * random.uniform();
    scene.a = back_project(pinhole, scene.segment.a.x(), scene.segment.a.y(), depth);
    scene.b = back_project(pinhole, scene.segment.b.x(), scene.segment.b.y(),
                           depth * (0.8 + 0.4 * random.uniform()));
    return scene;
  }

  double depth_at(double t_px) const {
    const double u = t_px / segment.length_px() + 0.5;
    return 1 / ((1 - u) / a.z() + u / b.z());
  }

  LineSamples exact_samples() const {
    LineSamples samples;
    samples.asked = samples.count = sample_count(segment, {});
    for (int i = 0; i < samples.count; ++i) {
      const double t = segment.length_px() * (static_cast<double>(i) / (samples.count - 1) - 0.5);
      samples.sample[static_cast<std::size_t>(i)] = {t, depth_at(t), DepthNoise{}.sigma(depth_at(t))};
    }
    return samples;
  }

  Vector3 point_at(double t_px) const {
    const double u = t_px / segment.length_px() + 0.5;
    const double z = depth_at(t_px);
    return a +
           u * z / b.z() *
               (b - a);  // under perspective the fraction along the line differs from that along its image
  }

  // Adds noise to the depth. The pixel noise displaces the position of the reading along the segment; first_t
  // and last_t return these positions for the two ends.
  LineSamples noisy_samples(Random& random, double sigma_p_px, const DepthNoise& noise,
                            double* first_t = nullptr, double* last_t = nullptr) const {
    LineSamples samples = exact_samples();
    for (int i = 0; i < samples.count; ++i) {
      LineSample& s = samples.sample[static_cast<std::size_t>(i)];
      const double true_t = s.t_px + sigma_p_px * gaussian(random);
      const double true_depth = depth_at(true_t);
      if (i == 0 && first_t != nullptr) *first_t = true_t;
      if (i + 1 == samples.count && last_t != nullptr) *last_t = true_t;
      s.depth_m = true_depth + noise.sigma(true_depth) * gaussian(random);
      s.sigma_d_m = noise.sigma(true_depth);
    }
    return samples;
  }
};

}  // namespace plvo::test
