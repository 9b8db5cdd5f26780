// SPDX-License-Identifier: Apache-2.0
// Any bytes as a camera, a configuration, and some frames with their priors. Each configuration works or is
// refused. Every result is sound (tests/support/sound.hpp) for any pixels, depths, stamps, priors and poses
// that are set. Zero bytes give the default case: the default configuration, and a textured wall that is
// tracked.
#include <algorithm>
#include <cstring>
#include <vector>

#include "plvo/base/random.hpp"
#include "plvo/map/map.hpp"
#include "plvo/odometry/odometry.hpp"
#include "scratch_file.hpp"
#include "sound.hpp"

namespace {

using namespace plvo;

// Reads values from the input; zeros once it is used up.
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
  // Returns the default for a zero byte, mostly a plausible number otherwise, and sometimes any bit pattern.
  double number(double usual, double low, double high) {
    const auto how = take<std::uint8_t>();
    if (how == 0) return usual;
    if (how == 255) return take<double>();
    return low + (high - low) * (how - 1) / 253.0;
  }
  double variance() {  // 1e-16 … 1e6
    double value = 1e-16;
    for (int n = take<std::uint8_t>() % 23; n > 0; --n) value *= 10;
    return std::min(value, 1e6);
  }
  int below(int bound) { return take<std::uint8_t>() % bound; }
  bool one_in(int n) { return below(n) == n - 1; }
  bool empty() const { return size_ == 0; }

 private:
  const std::uint8_t* data_;
  std::size_t size_;
};

// The smallest images in which tracking can start (keypoints keep 17 px from the border) give the most
// executions per second.
constexpr int kMostSide = 96;
// Many references and kept keyframes, or the minimum of everything.
constexpr Limits kLimits[] = {{.width = kMostSide,
                               .height = kMostSide,
                               .keypoints = 80,
                               .segments = 30,
                               .references = 3,
                               .kept_keyframes = 2,
                               .surfaces = 20},
                              {.width = kMostSide,
                               .height = kMostSide,
                               .keypoints = 50,
                               .segments = 16,
                               .references = 1,
                               .kept_keyframes = 0,
                               .surfaces = 0}};
constexpr int kMostPad = 8;

Config read_config(Bytes& bytes) {
  Config config;
  if (bytes.below(2) == 0) return config;
  const auto tune = [&bytes](double& entry, double low, double high) {
    entry = bytes.number(entry, low, high);
  };
  config.features = static_cast<Features>((bytes.below(3) + 2) % 3);
  config.surfaces = bytes.below(2) == 0;
  config.level_world = bytes.one_in(2);
  ReferenceConfig& references = config.references;
  references.policy = static_cast<ReferencePolicy>((bytes.below(4) + 2) % 4);
  references.max_lost_s = 0.03 * bytes.below(4);
  tune(references.keyframe_inlier_ratio, 0, 1);
  tune(references.process_noise_m_per_s, 0, 100);
  tune(references.process_noise_rad_per_s, 0, 100);
  config.points.registered = !bytes.one_in(4);
  config.points.depth_reach_px = (bytes.below(4) + 2) % 4;
  tune(config.points.sigma_px, 0.01, 2);
  config.motion.max_ransac_iterations = 1 + bytes.below(256) * 4;
  config.motion.min_inliers = 3 + bytes.below(16);
  config.motion.robust = bytes.below(2) == 0;
  tune(config.motion.max_sigma_m, 1e-6, 100);
  tune(config.motion.max_sigma_rad, 1e-6, 10);
  tune(config.noise.learning_rate, 0, 0.5);
  tune(config.noise.common_mode_share, 0, 1);
  tune(config.noise.point_correlation, 0, 1);
  tune(config.noise.shared_depth_m, 0, 1);
  tune(config.noise.angular_rate_error_rad_per_s, 0, 10);
  tune(config.depth_noise.c1, 0, 0.01);
  tune(config.depth_noise.floor_m, 1e-6, 0.1);
  config.budget.frame_ns = bytes.below(2) * 1000;
  config.budget.patience_frames = 1 + bytes.below(2);
  config.seed = bytes.take<std::uint8_t>();
  return config;
}

CameraModel read_camera(Bytes& bytes) {
  constexpr int kSizes[][2] = {{96, 72}, {80, 80}, {72, 64}, {64, 48}};
  const int* size = kSizes[bytes.below(4)];
  CameraModel camera{size[0],
                     size[1],
                     {bytes.number(80, 40, 200), bytes.number(80, 40, 200), size[0] / 2.0, size[1] / 2.0},
                     {}};
  if (bytes.below(2) == 0) return camera;
  Distortion& lens = camera.distortion;
  if (bytes.one_in(3)) lens.model = LensModel::kEquidistant;
  lens.k1 = bytes.number(0, -0.3, 0.3);
  lens.k2 = bytes.number(0, -0.1, 0.1);
  lens.k3 = bytes.number(0, -0.1, 0.1);
  if (lens.model == LensModel::kRational) {
    lens.p1 = bytes.number(0, -0.01, 0.01);
    lens.p2 = bytes.number(0, -0.01, 0.01);
  }
  lens.k4 = bytes.number(0, -0.1, 0.1);
  camera.readout_s = bytes.number(0, 0, 0.1);
  camera.depth_timing = {bytes.one_in(2), bytes.number(0, -0.1, 0.1), bytes.number(0, 0, 0.1)};
  camera.stamp_sigma_s = bytes.number(0, 0, 0.1);
  return camera;
}

// A frame in its own memory, which ends with the last row.
class Picture {
 public:
  // A frame with blocks of grey that move a little from frame to frame in front of a wall, or noise, or a
  // uniform image.
  RgbdFrame paint(const CameraModel& camera, Bytes& bytes) {
    RgbdFrame frame;
    const auto kind = bytes.take<std::uint8_t>();
    const auto look = bytes.take<std::uint8_t>();
    const int shift = look % 64;
    const auto pad = [&bytes](bool padded) { return padded ? bytes.below(kMostPad) : 0; };
    const bool padded = kind & 32;
    frame.colour.format = static_cast<PixelFormat>((kind >> 6) % 3);
    const int channels = frame.colour.format == PixelFormat::kGray8 ? 1 : 3;
    frame.colour.width = frame.depth.width = camera.width;
    frame.colour.height = frame.depth.height = camera.height;
    frame.colour.stride_bytes = camera.width * channels + pad(padded);
    frame.depth.stride = camera.width + pad(padded);
    frame.depth.metres_per_unit = bytes.number(0.001, 1e-4, 1e-2);
    Random random(kind % 4 == 3 ? bytes.take<std::uint16_t>() : 5);
    const int base = kind & 8 ? bytes.take<std::uint16_t>() : 1500;
    const int slope = kind & 16 ? bytes.take<std::uint8_t>() : 3;
    std::uint8_t* const colour = colour_.data() + colour_.size() -
                                 (camera.height - 1) * frame.colour.stride_bytes - camera.width * channels;
    std::uint16_t* const depth =
        depth_.data() + depth_.size() - (camera.height - 1) * frame.depth.stride - camera.width;
    for (int y = 0; y < camera.height; ++y)
      for (int x = 0; x < camera.width; ++x) {
        const auto block = static_cast<std::uint32_t>((x + shift) / 6 * 31 + y / 5 * 17);
        const std::uint32_t grey = kind % 4 == 2   ? 5
                                   : kind % 4 == 1 ? random.next()
                                                   : block * 2654435761U >> 13;
        for (int c = 0; c < channels; ++c)
          colour[y * frame.colour.stride_bytes + x * channels + c] = static_cast<std::uint8_t>(grey);
        depth[y * frame.depth.stride + x] = static_cast<std::uint16_t>(
            base + slope * (x + shift) % 700 + static_cast<int>(kind & 4 ? random.next() % 512 : 0));
      }
    frame.colour.data = colour;
    frame.depth.data = depth;
    if (look >= 252) frame.depth.data = nullptr;
    if (look == 251) frame.colour.width -= 1;
    if (look == 250) frame.depth.stride = 1;
    return frame;
  }

 private:
  std::vector<std::uint8_t> colour_ = std::vector<std::uint8_t>(kMostSide * (kMostSide * 3 + kMostPad));
  std::vector<std::uint16_t> depth_ = std::vector<std::uint16_t>(kMostSide * (kMostSide + kMostPad));
};

Vector3 read_vector(Bytes& bytes, double most) {
  Vector3 v;
  for (int i = 0; i < 3; ++i) v[i] = bytes.number(0, -most, most);
  return v;
}

// A covariance whose principal axes are rotated against the camera's.
Matrix3 read_covariance(Bytes& bytes) {
  const Matrix3 R = rotation_exp(read_vector(bytes, 2));
  Vector3 variances;
  variances.setConstant(bytes.variance());
  if (bytes.one_in(2)) variances[bytes.below(3)] = bytes.variance();
  const Matrix3 C = R * variances.asDiagonal() * R.transpose();
  return 0.5 * (C + Matrix3(C.transpose()));
}

MotionPrior read_prior(Bytes& bytes) {
  MotionPrior prior;
  const auto parts = bytes.take<std::uint8_t>();
  if (parts & 1) prior.rotation = {rotation_exp(read_vector(bytes, 0.1)), read_covariance(bytes)};
  if (parts & 2) prior.translation = {read_vector(bytes, parts & 64 ? 1000 : 0.1), read_covariance(bytes)};
  if (parts & 4)
    prior.gravity = {Vector3(0, 1, 0) + read_vector(bytes, 1), read_covariance(bytes), bytes.number(0, 0, 1)};
  return prior;
}

// A time step from a nanosecond to a century, forward or backward.
std::int64_t read_step(Bytes& bytes) {
  constexpr std::int64_t kFrame_ns = 33'333'333;
  const auto how = bytes.take<std::uint8_t>();
  if (how < 160) return kFrame_ns + how * 100'000LL;
  if (how < 223) return std::int64_t{1} << (how - 160);
  return -(std::int64_t{1} << (how - 223));
}

// Simulates calls between two frames; mostly none.
void act(Bytes& bytes, Odometry& odometry) {
  const auto action = bytes.take<std::uint8_t>();
  if (action < 200) return;
  if (action < 210) return odometry.reset();
  if (action < 220) return odometry.frame_took(bytes.below(2) * 2000);
  Matrix6 covariance = Matrix6::Zero();
  const auto kind = bytes.take<std::uint8_t>();
  if (kind & 1) covariance.block<3, 3>(0, 0) = read_covariance(bytes);
  if (kind & 2) covariance.block<3, 3>(3, 3) = read_covariance(bytes);
  if (kind & 4) covariance(bytes.below(6), bytes.below(6)) += bytes.number(0, -1, 1);
  const Se3 T{rotation_exp(read_vector(bytes, 3)), read_vector(bytes, kind & 8 ? 1e9 : 10)};
  (void)odometry.set_pose(T, covariance);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Bytes bytes(data, size);
  const Limits& limits = kLimits[bytes.below(2)];
  const CameraModel camera = read_camera(bytes);
  const Config config = read_config(bytes);
  static std::vector<std::byte> memory(std::max(required_bytes(kLimits[0]), required_bytes(kLimits[1])));
  static Odometry odometry;
  if (!odometry.init(memory, camera, config, limits).ok()) return 0;

  // A map beside it; small, so that keyframes have to make room.
  constexpr MapLimits kMap{8, 50, 16};
  static std::vector<std::byte> map_memory(Map::required_bytes(kMap, kMostSide, kMostSide));
  static Map map;
  fuzz::require(map.init(map_memory, camera, config, kMap).ok());

  static Picture picture;
  // Unsigned, so that it wraps around at the largest stamp; such a frame is refused.
  std::uint64_t stamp_ns = bytes.one_in(8) ? bytes.take<std::uint64_t>() : 0;
  for (int i = 0; i < 10 && !bytes.empty(); ++i) {
    RgbdFrame frame = picture.paint(camera, bytes);
    stamp_ns += static_cast<std::uint64_t>(read_step(bytes));
    frame.stamp_ns = static_cast<std::int64_t>(stamp_ns);
    frame.depth_stamp_ns = static_cast<std::int64_t>(
        stamp_ns + static_cast<std::uint64_t>(bytes.take<std::int8_t>() * 1'000'000LL));
    act(bytes, odometry);
    const TrackResult result = odometry.track(frame, read_prior(bytes));
    fuzz::require(test::is_sound(result));
    const MapResult in_map = map.update(odometry, result);
    fuzz::require(in_map.T_map_world.is_finite() && is_rotation(in_map.T_map_world.R) &&
                  is_covariance(in_map.pose_covariance));
  }
  return 0;
}
