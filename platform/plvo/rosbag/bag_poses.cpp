// SPDX-License-Identifier: Apache-2.0
#include "plvo/rosbag/bag_poses.hpp"

#include <fmt/core.h>

#include <vector>

#include "plvo/host/files/reader_limits.hpp"
#include "plvo/rosbag/listing.hpp"
#include "plvo/rosbag/messages/messages.hpp"

namespace plvo {

Status choose_bag_poses(const MessageFile& bag, const std::string& wanted, std::size_t& topic) {
  constexpr std::size_t kMostLetters = 120;
  std::vector<std::size_t> candidates;
  std::vector<std::string> names;
  for (std::size_t i = 0; i < bag.topics().size(); ++i) {
    const BagTopic& of = bag.topics()[i];
    if (of.type != kOdometryType && of.type != kPoseStampedType) continue;
    names.push_back(of.name);
    if (wanted.empty() || of.name == wanted) candidates.push_back(i);
  }
  if (candidates.empty())
    return {StatusCode::kNotFound,
            wanted.empty() ? "the recording has no poses (nav_msgs/Odometry or geometry_msgs/PoseStamped)"
                           : fmt::format("there are no poses on {}; poses are on: {}", wanted,
                                         names.empty() ? "no topic" : listed(names, kMostLetters))};
  if (candidates.size() > 1)
    return {StatusCode::kInvalidArgument,
            fmt::format("several topics have poses: choose with --truth-topic among {}",
                        listed(names, kMostLetters))};
  topic = candidates.front();
  return {};
}

Status read_bag_poses(MessageFile& bag, const std::string& wanted, Trajectory& trajectory) {
  trajectory = {};
  std::size_t chosen = 0;
  if (Status status = choose_bag_poses(bag, wanted, chosen); !status.ok()) return status;
  const std::string type = bag.topics()[chosen].type;
  const WireFormat wire = bag.topics()[chosen].wire;
  Trajectory found;
  const Status status =
      bag.visit(type, [&](std::size_t topic, std::span<const unsigned char> bytes) -> Status {
        if (topic != chosen) return {};
        if (found.poses.size() >= kMostRows)
          return {StatusCode::kInvalidArgument,
                  fmt::format("{} has more than {} poses, of which plvo takes no more",
                              bag.topics()[chosen].name, kMostRows)};
        PoseMessage pose;
        if (parse_pose(type, wire, bytes, pose).ok())
          found.poses.push_back({pose.stamp_ns, pose.pose});
        else
          ++found.ignored_rows;
        return {};
      });
  if (!status.ok()) return status;
  if (found.poses.empty())
    return {StatusCode::kDamaged, fmt::format("no pose on {} can be read", bag.topics()[chosen].name)};
  found.ignored_rows += keep_first_of_each_stamp(found.poses);
  trajectory = std::move(found);
  return {};
}

}  // namespace plvo
