// SPDX-License-Identifier: Apache-2.0
// Any bytes as a configuration and a few frames: every configuration is refused or works, no number that
// leaves is NaN or infinite, whatever the pixels, the depth, the stamps and the scale of depth were.
#include <cstring>
#include <vector>

#include "plvo/base/random.hpp"
#include "plvo/odometry/odometry.hpp"
#include "scratch_file.hpp"

namespace {

using namespace plvo;

// Reads values off the input; zeros when it is used up.
class Bytes {
 public:
  Bytes(const std::uint8_t* data, std::size_t size) : data_(data), size_(size) {}
  template <typename T>
  T take() {
    T value{};
    const std::size_t n = sizeof(T) < size_ ? sizeof(T) : size_;
    std::memcpy(&value, data_, n);
    data_ += n;
    size_ -= n;
    return value;
  }
  // Mostly a sensible number, now and then any bit pattern at all.
  double number(double low, double high) {
    const auto how = take<std::uint8_t>();
    if (how == 255) return take<double>();
    return low + (high - low) * how / 254.0;
  }
  bool empty() const { return size_ == 0; }

 private:
  const std::uint8_t* data_;
  std::size_t size_;
};

// The smallest images that are taken: the most executions a second.
constexpr Limits kLimits{
    .width = 64, .height = 64, .keypoints = 60, .segments = 30, .references = 3, .surfaces = 20};

Config read_config(Bytes& bytes) {
  Config config;
  config.features = static_cast<Features>(bytes.take<std::uint8_t>() % 4);
  config.references.policy = static_cast<ReferencePolicy>(bytes.take<std::uint8_t>() % 3);
  config.points.sigma_px = bytes.number(0.1, 2);
  config.points.detector.levels = bytes.take<std::uint8_t>() % 6;
  config.points.detector.cell_px = bytes.take<std::uint8_t>();
  config.points.detector.noise_floor = bytes.take<std::uint8_t>();
  config.points.detector.min_strength = bytes.number(0, 20);
  config.points.match.radius_px = bytes.number(0, 100);
  config.lines.guided_offset_px = bytes.number(0, 50);
  config.lines.guided_angle_rad = bytes.number(0, 1);
  config.motion.inlier_probability = bytes.number(0.5, 1);
  config.motion.max_ransac_iterations = bytes.take<std::uint8_t>() * 4;
  config.motion.min_inliers = bytes.take<std::uint8_t>() % 30;
  config.motion.robust = bytes.take<std::uint8_t>() % 2 == 0;
  config.depth_noise.c1 = bytes.number(0, 0.01);
  config.seed = bytes.take<std::uint8_t>();
  return config;
}

// A picture: blocks of random grey that move a little from frame to frame, or pure noise, or flat.
void paint(Bytes& bytes, std::vector<std::uint8_t>& colour, std::vector<std::uint16_t>& depth) {
  const auto kind = bytes.take<std::uint8_t>();
  const int shift = kind / 8;
  Random random(kind % 4 == 3 ? bytes.take<std::uint16_t>() : 5);
  const auto base = bytes.take<std::uint16_t>();
  const auto slope = bytes.take<std::uint8_t>();
  for (int y = 0; y < kLimits.height; ++y)
    for (int x = 0; x < kLimits.width; ++x) {
      const auto k = static_cast<std::size_t>(y * kLimits.width + x);
      const auto block = static_cast<std::uint32_t>((x + shift) / 9 * 31 + y / 7 * 17);
      const std::uint32_t grey = kind % 4 == 0   ? 128
                                 : kind % 4 == 1 ? random.next()
                                                 : block * 2654435761U >> 13;
      colour[k] = static_cast<std::uint8_t>(grey);
      depth[k] =
          static_cast<std::uint16_t>(base + slope * x + static_cast<int>(kind & 4 ? random.next() % 512 : 0));
    }
}

bool finite(const TrackResult& result) {
  return result.T_world_camera.is_finite() && result.T_camera_reference.is_finite() &&
         result.pose_covariance.allFinite() && result.motion_covariance.allFinite() &&
         result.mean_brightness - result.mean_brightness == 0;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Bytes bytes(data, size);
  const Config config = read_config(bytes);
  CameraModel camera{kLimits.width,
                     kLimits.height,
                     {bytes.number(40, 200), bytes.number(40, 200), kLimits.width / 2, kLimits.height / 2},
                     {}};
  camera.distortion.k1 = bytes.number(-0.3, 0.3);

  static std::vector<std::byte> memory(required_bytes(kLimits));
  Odometry odometry;
  if (!odometry.init(memory, camera, config, kLimits).ok()) return 0;

  constexpr std::size_t kPixels = static_cast<std::size_t>(kLimits.width) * kLimits.height;
  static std::vector<std::uint8_t> colour(kPixels);
  static std::vector<std::uint16_t> depth(kPixels);
  std::int64_t stamp_ns = 0;
  for (int i = 0; i < 6 && !bytes.empty(); ++i) {
    paint(bytes, colour, depth);
    RgbdFrame frame;
    stamp_ns += bytes.take<std::int8_t>() * 1'000'000LL + 30'000'000;
    frame.stamp_ns = stamp_ns;
    frame.depth_stamp_ns = stamp_ns;
    frame.colour = {colour.data(), kLimits.width, kLimits.height, kLimits.width, PixelFormat::kGray8};
    frame.depth = {depth.data(), kLimits.width, kLimits.height, kLimits.width, bytes.number(1e-4, 1e-2)};
    if (bytes.take<std::uint8_t>() % 16 == 15) frame.depth.data = nullptr;
    if (bytes.take<std::uint8_t>() % 16 == 15) frame.colour.width -= 1;
    fuzz::require(finite(odometry.track(frame)));
  }
  return 0;
}
