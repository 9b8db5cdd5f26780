// SPDX-License-Identifier: Apache-2.0
#include "plvo/rosbag/bag_imu.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <string>
#include <vector>

#include "plvo/rosbag/messages.hpp"

namespace plvo {
namespace {

using Samples = std::vector<ImuSample>;

struct ImuTopic {
  std::size_t topic = 0;  // of the bag
  Samples gyro, accelerometer;
  std::size_t damaged = 0;
};

// Which sensor is looked for.
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

// All that the bag has.
Status read_topics(BagFile& bag, std::vector<ImuTopic>& topics) {
  for (std::size_t i = 0; i < bag.topics().size(); ++i)
    if (bag.topics()[i].type == kImuType) topics.push_back({i, {}, {}, 0});
  std::vector<unsigned char> bytes;
  for (const BagMessage& message : bag.messages()) {
    const auto topic = std::find_if(topics.begin(), topics.end(),
                                    [&](const ImuTopic& t) { return t.topic == message.topic; });
    if (topic == topics.end()) continue;
    ImuMessage imu;
    Status status = bag.read(message, bytes);
    if (status.code() == StatusCode::kIo) return status;
    if (status.ok()) status = parse_imu(bytes, imu);
    if (!status.ok()) ++topic->damaged;
    if (imu.rate) topic->gyro.push_back({imu.stamp_ns, *imu.rate});
    if (imu.force) topic->accelerometer.push_back({imu.stamp_ns, *imu.force});
  }
  for (ImuTopic& topic : topics) {
    drop_if_zero(topic.gyro);
    drop_if_zero(topic.accelerometer);
  }
  return {};
}

std::string in_words(const BagFile& bag, const std::vector<const ImuTopic*>& topics) {
  constexpr std::size_t kMostLetters = 120;  // a status is short
  std::string text;
  for (std::size_t i = 0; i < topics.size(); ++i) {
    const std::string& name = bag.topics()[topics[i]->topic].name;
    if (text.size() + name.size() > kMostLetters)
      return text + fmt::format(" and {} more", topics.size() - i);
    text += (i == 0 ? "" : ", ") + name;
  }
  return text;
}

// Stays nullptr where the bag has no such sensor and none was named.
Status choose(const BagFile& bag, const std::vector<ImuTopic>& topics, const Sensor& sensor,
              const std::string& wanted, const ImuTopic*& chosen) {
  std::vector<const ImuTopic*> candidates;
  for (const ImuTopic& topic : topics)
    if (!(topic.*sensor.samples).empty()) candidates.push_back(&topic);
  chosen = nullptr;
  for (const ImuTopic* topic : candidates)
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

// Returns how many were left out.
std::size_t take_in_order(const Samples& from, Samples& samples) {
  std::copy_if(from.begin(), from.end(), std::back_inserter(samples),
               [](const ImuSample& s) { return s.value.allFinite(); });
  std::stable_sort(samples.begin(), samples.end(),
                   [](const ImuSample& a, const ImuSample& b) { return a.stamp_ns < b.stamp_ns; });
  samples.erase(std::unique(samples.begin(), samples.end(),
                            [](const ImuSample& a, const ImuSample& b) { return a.stamp_ns == b.stamp_ns; }),
                samples.end());
  return from.size() - samples.size();
}

}  // namespace

Status read_bag_imu(BagFile& bag, const BagTopicNames& names, ImuRecording& recording) {
  recording = {};
  std::vector<ImuTopic> topics;
  if (Status status = read_topics(bag, topics); !status.ok()) return status;
  const ImuTopic *gyro = nullptr, *accelerometer = nullptr;
  Status status = choose(bag, topics, kGyro, names.gyro, gyro);
  if (status.ok()) status = choose(bag, topics, kAccelerometer, names.accelerometer, accelerometer);
  if (!status.ok()) return status;
  if (gyro == nullptr && accelerometer == nullptr)
    return {StatusCode::kNotFound,
            "the bag has no readings of a gyro or an accelerometer (sensor_msgs/Imu that is not zero)"};
  if (gyro != nullptr) recording.ignored += gyro->damaged + take_in_order(gyro->gyro, recording.gyro);
  if (accelerometer != nullptr)
    recording.ignored += (accelerometer == gyro ? 0 : accelerometer->damaged) +
                         take_in_order(accelerometer->accelerometer, recording.accelerometer);
  return {};
}

}  // namespace plvo
