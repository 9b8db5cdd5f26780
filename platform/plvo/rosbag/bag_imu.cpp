// SPDX-License-Identifier: Apache-2.0
#include "plvo/rosbag/bag_imu.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "plvo/host/files/reader_limits.hpp"
#include "plvo/host/files/trajectory_reader.hpp"
#include "plvo/rosbag/listing.hpp"
#include "plvo/rosbag/messages/messages.hpp"

namespace plvo {
namespace {

using Samples = std::vector<ImuSample>;

struct ImuTopic {
  std::size_t topic = 0;  // of the bag
  Samples gyro, accelerometer;
  std::size_t damaged = 0;
};

// The sensor that is searched.
struct Sensor {
  const char *name, *one;
  Samples ImuTopic::*samples;
};
constexpr Sensor kGyro = {"gyro", "a gyro", &ImuTopic::gyro};
constexpr Sensor kAccelerometer = {"accelerometer", "an accelerometer", &ImuTopic::accelerometer};

void drop_if_zero(Samples& samples) {
  const bool zero =
      std::all_of(samples.begin(), samples.end(), [](const ImuSample& s) { return s.value.isZero(0); });
  if (zero) samples.clear();
}

// Reads all IMU topics of the bag.
Status read_topics(MessageFile& bag, std::vector<ImuTopic>& topics) {
  for (std::size_t i = 0; i < bag.topics().size(); ++i)
    if (bag.topics()[i].type == kImuType) topics.push_back({i, {}, {}, 0});
  std::size_t readings = 0;
  const Status status = bag.visit(kImuType, [&](std::size_t number, std::span<const unsigned char> bytes) {
    const auto topic =
        std::find_if(topics.begin(), topics.end(), [number](const ImuTopic& t) { return t.topic == number; });
    ImuMessage imu;
    if (!parse_imu(bag.topics()[number].wire, bytes, imu).ok()) ++topic->damaged;
    readings += (imu.rate ? 1 : 0) + (imu.force ? 1 : 0);
    if (readings > kMostReadings)
      return Status(StatusCode::kInvalidArgument,
                    fmt::format("the bag has more than {} readings of gyros and accelerometers, of which "
                                "plvo takes no more; split it",
                                kMostReadings));
    if (imu.rate) topic->gyro.push_back({imu.stamp_ns, *imu.rate});
    if (imu.force) topic->accelerometer.push_back({imu.stamp_ns, *imu.force});
    return Status();
  });
  if (!status.ok()) return status;
  for (ImuTopic& topic : topics) {
    drop_if_zero(topic.gyro);
    drop_if_zero(topic.accelerometer);
  }
  return {};
}

std::string in_words(const MessageFile& bag, const std::vector<ImuTopic*>& topics) {
  constexpr std::size_t kMostLetters = 120;
  std::vector<std::string> names;
  for (const ImuTopic* topic : topics) names.push_back(bag.topics()[topic->topic].name);
  return listed(names, kMostLetters);
}

// chosen is nullptr if the bag has no such sensor and none was named.
Status choose(const MessageFile& bag, std::vector<ImuTopic>& topics, const Sensor& sensor,
              const std::string& wanted, ImuTopic*& chosen) {
  std::vector<ImuTopic*> candidates;
  for (ImuTopic& topic : topics)
    if (!(topic.*sensor.samples).empty()) candidates.push_back(&topic);
  chosen = nullptr;
  for (ImuTopic* topic : candidates)
    if (!wanted.empty() && bag.topics()[topic->topic].name == wanted) chosen = topic;
  if (chosen != nullptr || (wanted.empty() && candidates.empty())) return {};
  const std::string have = candidates.empty() ? "no topic has" : "they are on " + in_words(bag, candidates);
  if (!wanted.empty())
    return {StatusCode::kNotFound,
            fmt::format("there are no readings of {} (sensor_msgs/Imu) on {}; {}", sensor.one, wanted, have)};
  if (candidates.size() > 1)
    return {StatusCode::kInvalidArgument,
            fmt::format("several topics have readings of {0}: choose with --{1}-topic or topics.{1}; {2}",
                        sensor.one, sensor.name, have)};
  chosen = candidates.front();
  return {};
}

// Sorts samples by stamp. left_out: grows by the number of samples that are not finite or repeat a stamp.
Status take_in_order(Samples& from, const std::string& topic, Samples& samples, std::size_t& left_out) {
  const std::size_t all = from.size();
  std::erase_if(from, [](const ImuSample& s) { return !s.value.allFinite(); });
  const std::size_t repeated = keep_first_of_each_stamp(from);
  if (repeated > 0 && from.size() == 1)
    return not_stamped("readings", repeated + 1, topic, from.front().stamp_ns);
  left_out += all - from.size();
  samples = std::move(from);
  return {};
}

}  // namespace

Status read_bag_imu(MessageFile& bag, const BagTopicNames& names, ImuRecording& recording) {
  recording = {};
  std::vector<ImuTopic> topics;
  if (Status status = read_topics(bag, topics); !status.ok()) return status;
  ImuTopic *gyro = nullptr, *accelerometer = nullptr;
  Status status = choose(bag, topics, kGyro, names.gyro, gyro);
  if (status.ok()) status = choose(bag, topics, kAccelerometer, names.accelerometer, accelerometer);
  if (!status.ok()) return status;
  if (gyro == nullptr && accelerometer == nullptr)
    return {StatusCode::kNotFound,
            "the bag has no readings of a gyro or an accelerometer (sensor_msgs/Imu that is not zero)"};
  const auto name = [&bag](const ImuTopic* topic) { return bag.topics()[topic->topic].name; };
  if (gyro != nullptr) {
    recording.ignored += gyro->damaged;
    status = take_in_order(gyro->gyro, name(gyro), recording.gyro, recording.ignored);
  }
  if (status.ok() && accelerometer != nullptr) {
    recording.ignored += accelerometer == gyro ? 0 : accelerometer->damaged;
    status = take_in_order(accelerometer->accelerometer, name(accelerometer), recording.accelerometer,
                           recording.ignored);
  }
  return status;
}

}  // namespace plvo
