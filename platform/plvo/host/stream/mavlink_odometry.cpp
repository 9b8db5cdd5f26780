// SPDX-License-Identifier: Apache-2.0
#include "plvo/host/stream/mavlink_odometry.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "plvo/host/files/trajectory_file.hpp"

namespace plvo {
namespace {

constexpr std::uint8_t kMavlink2 = 0xfd;
constexpr std::uint32_t kOdometryId = 331;
constexpr std::uint8_t kOdometryCrcExtra = 91;  // of the names and types of the fields; the test computes it
constexpr std::uint8_t kBodyFrd = 12, kLocalFrd = 20;  // MAV_FRAME
constexpr std::uint8_t kVisionEstimator = 2;           // MAV_ESTIMATOR_TYPE
const Vector3 kFrdOfFlu(1, -1, -1);                    // the diagonal of a turn by 180° about x

class MavlinkPayload {
 public:
  void byte(std::uint8_t value) { bytes_.push_back(value); }
  template <typename Unsigned>
  void little_endian(Unsigned value) {
    for (std::size_t i = 0; i < sizeof value; ++i) byte(static_cast<std::uint8_t>(value >> (8 * i)));
  }
  void number(double value) { little_endian(std::bit_cast<std::uint32_t>(static_cast<float>(value))); }
  void vector(const Vector3& v) {
    for (int k = 0; k < 3; ++k) number(v[k]);
  }
  void upper_triangle(const Matrix6& m) {
    for (int row = 0; row < 6; ++row)
      for (int column = row; column < 6; ++column) number(m(row, column));
  }
  std::vector<std::uint8_t>& bytes() { return bytes_; }

 private:
  std::vector<std::uint8_t> bytes_;
};

Matrix6 turned_to_frd(const Matrix6& covariance) {
  Vector6 signs;
  signs << kFrdOfFlu, kFrdOfFlu;
  return signs.asDiagonal() * covariance * signs.asDiagonal();
}

// Percent of the matches that agree with the motion; 1, the worst, where no motion was measured.
std::uint8_t quality_of(const TrackResult& base) {
  const int matched = base.points.matched + base.lines.matched;
  const int inliers = base.points.inliers + base.lines.inliers;
  if (base.state == TrackState::kPredicted || matched == 0) return 1;
  return static_cast<std::uint8_t>(std::clamp(100 * inliers / matched, 1, 100));
}

// The fields in the order of the wire: by size of their type, then as described.
MavlinkPayload payload_of(const TrackResult& base, const std::optional<Twist>& twist, std::uint8_t resets) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  MavlinkPayload payload;
  payload.little_endian(static_cast<std::uint64_t>(base.stamp_ns / 1000));
  payload.vector(kFrdOfFlu.cwiseProduct(base.T_world_camera.t));
  // The axis of the rotation turns with the frames, its angle stays.
  const Quaternion q = to_quaternion(base.T_world_camera.R);
  payload.number(q.w);
  payload.vector(kFrdOfFlu.cwiseProduct(Vector3(q.x, q.y, q.z)));
  const Vector3 none = Vector3::Constant(kNone);
  payload.vector(twist ? Vector3(kFrdOfFlu.cwiseProduct(twist->velocity.head<3>())) : none);
  payload.vector(twist ? Vector3(kFrdOfFlu.cwiseProduct(twist->velocity.tail<3>())) : none);
  payload.upper_triangle(turned_to_frd(base.pose_covariance));
  Matrix6 of_velocity = Matrix6::Zero();
  of_velocity(0, 0) = kNone;
  payload.upper_triangle(twist ? turned_to_frd(twist->covariance) : of_velocity);
  payload.byte(kLocalFrd);
  payload.byte(kBodyFrd);
  payload.byte(resets);
  payload.byte(kVisionEstimator);
  payload.byte(quality_of(base));
  return payload;
}

}  // namespace

std::uint16_t crc16_mcrf4xx(std::span<const std::uint8_t> bytes, std::uint16_t crc) {
  for (const std::uint8_t byte : bytes) {
    crc = static_cast<std::uint16_t>(crc ^ byte);
    for (int bit = 0; bit < 8; ++bit)
      crc = static_cast<std::uint16_t>((crc & 1) != 0 ? (crc >> 1) ^ 0x8408 : crc >> 1);
  }
  return crc;
}

std::optional<std::vector<std::uint8_t>> MavlinkOdometry::message(const TrackResult& base) {
  const std::optional<Twist> twist = twist_.of(base);
  if (!has_pose(base)) {
    twist_.forget();
    return std::nullopt;
  }
  if (started_ && (base.relocalised || base.world != world_)) ++resets_;
  started_ = true;
  world_ = base.world;
  MavlinkPayload payload = payload_of(base, twist, resets_);
  // MAVLink 2 leaves zeros at the end of the payload away.
  while (payload.bytes().size() > 1 && payload.bytes().back() == 0) payload.bytes().pop_back();

  MavlinkPayload frame;
  frame.byte(kMavlink2);
  frame.byte(static_cast<std::uint8_t>(payload.bytes().size()));
  frame.byte(0);  // flags that a reader must know: no signature
  frame.byte(0);  // flags that it may ignore
  frame.byte(sequence_++);
  frame.byte(kSystem);
  frame.byte(kComponent);
  for (int i = 0; i < 3; ++i) frame.byte(static_cast<std::uint8_t>(kOdometryId >> (8 * i)));
  std::vector<std::uint8_t>& bytes = frame.bytes();
  bytes.insert(bytes.end(), payload.bytes().begin(), payload.bytes().end());
  const std::uint16_t crc = crc16_mcrf4xx(std::span(bytes).subspan(1));
  const std::uint8_t extra[] = {kOdometryCrcExtra};
  frame.little_endian(crc16_mcrf4xx(extra, crc));
  return bytes;
}

}  // namespace plvo
