// SPDX-License-Identifier: Apache-2.0
#include "plvo/cli/common/base_option.hpp"

#include <fmt/core.h>

#include <cmath>

#include "plvo/host/robot_base.hpp"

namespace plvo::cli {
namespace {

constexpr const char* kOption = "--base-camera";
constexpr NumberRange kNumbers = {-1000, 1000};
constexpr double kLengthTolerance = 0.01;  // two decimals of a quaternion are enough

}  // namespace

TrackResult BaseOption::apply(const TrackResult& result) const {
  return T_base_camera ? result_of_base(result, *T_base_camera) : result;
}

void add_base_option(OptionGroup& group, BaseOption& option) {
  takes_values(
      group.add(
          kOption, "NUMBER",
          "Where the camera (x right, y down, z forward) sits in the robot's base (x forward, y left, z up): "
          "tx ty tz qx qy qz qw. Files and streams are then of base_link in odom. A camera that looks "
          "ahead has the quaternion -0.5 0.5 -0.5 0.5",
          [&option](const std::string& text) {
            double number = 0;
            std::string wrong = read_number(text, kNumbers, number);
            if (wrong.empty()) option.numbers.push_back(number);
            return wrong;
          }),
      7, 7);
}

void check_base_option(BaseOption& option, bool poses_are_written) {
  const std::vector<double>& n = option.numbers;
  if (n.empty()) return;
  const double length = std::hypot(std::hypot(n[3], n[4]), std::hypot(n[5], n[6]));
  if (!(std::abs(length - 1) <= kLengthTolerance))
    refuse(
        kOption,
        fmt::format("the quaternion qx qy qz qw must have the length 1, not {:.4g}; after tx ty tz (metres) "
                    "come qx qy qz qw, w last",
                    length));
  if (!poses_are_written)
    refuse(kOption,
           "changes what is written: add --out, --covariance, --motions or --stream, or leave it away");
  option.T_base_camera = Se3{to_rotation({n[3], n[4], n[5], n[6]}), {n[0], n[1], n[2]}};
}

void warn_of_base_option(const BaseOption& option, Log& log) {
  constexpr double kNearlyOne = 0.9999;  // of the cosine of half the angle: 1.6°
  if (!option.numbers.empty() && std::abs(option.numbers[6]) > kNearlyOne)
    log.write(
        LogLevel::kWarning,
        "--base-camera has no rotation: this camera looks up, along the base's z, with the image's right "
        "to the front; one that looks ahead has the quaternion -0.5 0.5 -0.5 0.5");
}

}  // namespace plvo::cli
