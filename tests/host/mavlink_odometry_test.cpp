// SPDX-License-Identifier: Apache-2.0
// Tests what MAVLink's ODOMETRY says about lost frames, new worlds and quality. The encoding itself is
// compared with an independent decoder (mavlink_test).
#include "plvo/host/stream/mavlink_odometry.hpp"

#include <gtest/gtest.h>

#include "plvo/host/stream/mavlink_stream.hpp"

namespace plvo {
namespace {

constexpr std::size_t kHeader = 10;
constexpr std::size_t kResets = kHeader + 230, kQuality = kHeader + 232;

TrackResult tracked(int frame) {
  TrackResult result;
  result.state = frame == 0 ? TrackState::kInitialising : TrackState::kTracking;
  result.stamp_ns = 1'000'000'000 + frame * 33'000'000LL;
  result.points.matched = 80;
  result.points.inliers = 55;
  result.lines.matched = 20;
  result.lines.inliers = 20;
  return result;
}

TEST(MavlinkOdometry, ChecksumHasThePublishedCheckValue) {
  const std::string digits = "123456789";
  EXPECT_EQ(crc16_mcrf4xx({reinterpret_cast<const std::uint8_t*>(digits.data()), digits.size()}), 0x6F91);
}

TEST(MavlinkOdometry, LostFramesAreNotSent) {
  MavlinkOdometry odometry;
  TrackResult lost = tracked(1);
  lost.state = TrackState::kLost;
  EXPECT_TRUE(odometry.message(tracked(0)));
  EXPECT_FALSE(odometry.message(lost));
  const auto after = odometry.message(tracked(2));
  ASSERT_TRUE(after);
  EXPECT_EQ((*after)[4], 1) << "the sequence counts what was sent";
}

TEST(MavlinkOdometry, ResetsAreCounted) {
  MavlinkOdometry odometry;
  (void)odometry.message(tracked(0));
  EXPECT_EQ(odometry.message(tracked(1))->at(kResets), 0);
  TrackResult relocalised = tracked(2);
  relocalised.relocalised = true;
  EXPECT_EQ(odometry.message(relocalised)->at(kResets), 1);
  TrackResult restarted = tracked(3);
  restarted.state = TrackState::kInitialising;
  restarted.restarted = true;
  EXPECT_EQ(odometry.message(restarted)->at(kResets), 1) << "from the last good pose";
  TrackResult new_world = tracked(4);
  new_world.state = TrackState::kInitialising;
  new_world.world = 1;
  EXPECT_EQ(odometry.message(new_world)->at(kResets), 2);
  TrackResult next = tracked(5);
  next.world = 1;
  EXPECT_EQ(odometry.message(next)->at(kResets), 2);
}

TEST(MavlinkOdometry, QualityIsTheInlierRatio) {
  MavlinkOdometry odometry;
  (void)odometry.message(tracked(0));
  EXPECT_EQ(odometry.message(tracked(1))->at(kQuality), 75);
  TrackResult predicted = tracked(2);
  predicted.state = TrackState::kPredicted;
  EXPECT_EQ(odometry.message(predicted)->at(kQuality), 1);
}

TEST(MavlinkStream, AddressesThatDoNotExistAreNamed) {
  MavlinkStream stream;
  EXPECT_EQ(stream.open("nonsense").code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(stream.open("no.such.host.invalid:14550").code(), StatusCode::kInvalidArgument);
  EXPECT_FALSE(stream.is_open());
  ASSERT_TRUE(stream.open("127.0.0.1:9").ok());
  for (int i = 0; i < 3; ++i)
    EXPECT_TRUE(stream.write(tracked(i)).ok()) << "nobody listens, and nothing ends";
}

}  // namespace
}  // namespace plvo
