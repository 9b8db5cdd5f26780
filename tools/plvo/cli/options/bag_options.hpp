// SPDX-License-Identifier: Apache-2.0
// Which topics of a recording of ROS are read: options of every command that reads bags.
#pragma once

#include <cstdint>

#include "plvo/cli/options/arguments.hpp"
#include "plvo/recording/recording.hpp"

namespace plvo::cli {

inline constexpr const char* kBagGroup = "ROS bag";
// kWithTruth: the topics of gyro and accelerometer, for --imu, and that of the true poses can be chosen too.
enum class BagImu : std::uint8_t { kPassedOver, kWithTruth };
void add_bag_options(CLI::App& command, BagTopicNames& topics, BagImu imu);
// Where no recording is a bag.
void refuse_bag_options(const CLI::App& command);

}  // namespace plvo::cli
