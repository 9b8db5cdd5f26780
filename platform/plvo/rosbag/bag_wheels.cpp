// SPDX-License-Identifier: Apache-2.0
#include "plvo/rosbag/bag_wheels.hpp"

#include <fmt/core.h>

#include <cmath>
#include <utility>
#include <vector>

#include "plvo/host/files/reader_limits.hpp"
#include "plvo/host/files/trajectory_reader.hpp"
#include "plvo/rosbag/listing.hpp"
#include "plvo/rosbag/messages/messages.hpp"

namespace plvo {
namespace {

Status choose_bag_wheels(const MessageFile& bag, const std::string& wanted, std::size_t& topic) {
  constexpr std::size_t kMostLetters = 120;
  std::vector<std::string> names;
  for (std::size_t i = 0; i < bag.topics().size(); ++i) {
    if (bag.topics()[i].type != kOdometryType) continue;
    names.push_back(bag.topics()[i].name);
    topic = i;
    if (names.back() == wanted) return {};
  }
  return {StatusCode::kNotFound,
          fmt::format("there is no odometry of wheels on {}; nav_msgs/Odometry is on: {}", wanted,
                      names.empty() ? "no topic" : listed(names, kMostLetters))};
}

}  // namespace

Status read_bag_wheels(MessageFile& bag, const std::string& wanted, WheelRecording& recording) {
  recording = {};
  std::size_t chosen = 0;
  if (Status status = choose_bag_wheels(bag, wanted, chosen); !status.ok()) return status;
  const WireFormat wire = bag.topics()[chosen].wire;
  WheelRecording found;
  found.has_sigma = true;
  std::vector<WheelSample>& samples = found.samples;
  const Status status =
      bag.visit(kOdometryType, [&](std::size_t topic, std::span<const unsigned char> bytes) -> Status {
        if (topic != chosen) return {};
        if (samples.size() >= kMostRows)
          return {
              StatusCode::kInvalidArgument,
              fmt::format("{} has more than {} messages, of which plvo takes no more", wanted, kMostRows)};
        TwistMessage message;
        const bool good = parse_twist(wire, bytes, message).ok() && message.twist.allFinite();
        if (!good) {
          ++found.ignored;
          return {};
        }
        const Vector6 &v = message.twist, &variance = message.variance;
        samples.push_back({message.stamp_ns,
                           {v[0], v[1], v[5]},
                           {std::sqrt(variance[0]), std::sqrt(variance[1]), std::sqrt(variance[5])}});
        found.has_sigma = found.has_sigma && variance[0] > 0 && variance[1] > 0 && variance[5] > 0 &&
                          samples.back().sigma.allFinite();
        return {};
      });
  if (!status.ok()) return status;
  if (samples.empty())
    return {StatusCode::kDamaged, fmt::format("no odometry of wheels on {} can be read", wanted)};
  found.ignored += keep_first_of_each_stamp(samples);
  recording = std::move(found);
  return {};
}

}  // namespace plvo
