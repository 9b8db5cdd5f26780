// SPDX-License-Identifier: Apache-2.0
// Stand-ins for what the node for ROS 2 uses of rclcpp, message_filters and tf2, which Debian does not have:
// members and signatures as it calls them, and no more. A test puts messages in by hand and takes them out.
// The messages are not stand-ins: make_messages.py.
#pragma once

#include <any>
#include <builtin_interfaces/msg/time.hpp>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <geometry_msgs/msg/transform_stamped.hpp>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace rclcpp {

// What a test puts in and takes out, by the name of the topic.
struct Wires {
  std::map<std::string, std::any> parameters;
  std::map<std::string, std::function<void(const std::shared_ptr<const void>&)>> subscriptions, services;
  std::map<std::string, std::size_t> depths;  // of the queues
  std::map<std::string, bool> best_effort;
  std::map<std::string, std::vector<std::any>> published;
  std::vector<std::function<void()>> timers;
  std::map<std::pair<std::string, std::string>, geometry_msgs::msg::TransformStamped> transforms;  // of tf
  std::vector<geometry_msgs::msg::TransformStamped> sent_transforms;
  std::vector<std::string> logged;
};
inline Wires wires;
inline std::function<void()> while_spinning;

class Time {
 public:
  explicit Time(std::int64_t nanoseconds) : nanoseconds_(nanoseconds) {}
  explicit Time(const builtin_interfaces::msg::Time& time)
      : nanoseconds_(std::int64_t{1'000'000'000} * time.sec + time.nanosec) {}
  std::int64_t nanoseconds() const { return nanoseconds_; }
  operator builtin_interfaces::msg::Time() const {
    builtin_interfaces::msg::Time time;
    time.sec = static_cast<std::int32_t>(nanoseconds_ / 1'000'000'000);
    time.nanosec = static_cast<std::uint32_t>(nanoseconds_ % 1'000'000'000);
    return time;
  }

 private:
  std::int64_t nanoseconds_;
};
struct Duration {
  static Duration from_seconds(double seconds) { return {seconds}; }
  double seconds_ = 0;
};

struct QoS {
  explicit QoS(std::size_t depth) : depth_(depth) {}
  QoS& keep_last(std::size_t depth) { return depth_ = depth, *this; }
  std::size_t depth_;
  bool best_effort_ = false;
};
struct SensorDataQoS : QoS {
  SensorDataQoS() : QoS(5) { best_effort_ = true; }
};

struct Logger {};
inline void log(const Logger&, const char* format, const char* text) {
  char line[512];
  std::snprintf(line, sizeof line, format, text);
  wires.logged.emplace_back(line);
}
#define RCLCPP_INFO(...) rclcpp::log(__VA_ARGS__)
#define RCLCPP_WARN(...) rclcpp::log(__VA_ARGS__)

struct Clock {
  using SharedPtr = std::shared_ptr<Clock>;
};
struct TimerBase {
  using SharedPtr = std::shared_ptr<TimerBase>;
};
template <typename Type>
struct Service {
  using SharedPtr = std::shared_ptr<Service>;
};

template <typename Message>
struct Subscription {
  using SharedPtr = std::shared_ptr<Subscription>;
  explicit Subscription(std::string name) : name_(std::move(name)) {}
  const char* get_topic_name() const { return name_.c_str(); }
  std::string name_;
};
template <typename Message>
struct Publisher {
  using SharedPtr = std::shared_ptr<Publisher>;
  explicit Publisher(std::string name) : name_(std::move(name)) {}
  void publish(const Message& message) { wires.published[name_].emplace_back(message); }
  std::string name_;
};

class Node {
 public:
  explicit Node(const std::string& name) : name_(name) {}
  const char* get_name() const { return name_.c_str(); }
  Clock::SharedPtr get_clock() const { return std::make_shared<Clock>(); }
  Time now() const { return Time(std::int64_t{7'000'000'000}); }
  Logger get_logger() const { return {}; }

  // Whole numbers come back with 64 bits, as in rclcpp.
  template <typename Value>
  auto declare_parameter(const std::string& name, const Value& fallback) {
    using Kept =
        std::conditional_t<std::is_integral_v<Value> && !std::is_same_v<Value, bool>, std::int64_t, Value>;
    const auto found = wires.parameters.find(name);
    if (found == wires.parameters.end()) return static_cast<Kept>(fallback);
    if (const auto* value = std::any_cast<Kept>(&found->second)) return *value;
    throw std::runtime_error("parameter '" + name + "' has invalid type");
  }
  template <typename Message>
  typename Publisher<Message>::SharedPtr create_publisher(const std::string& topic, const QoS&) {
    return std::make_shared<Publisher<Message>>(topic);
  }
  template <typename Message, typename Callback>
  typename Subscription<Message>::SharedPtr create_subscription(const std::string& topic, const QoS& qos,
                                                                Callback callback) {
    wires.depths[topic] = qos.depth_;
    wires.best_effort[topic] = qos.best_effort_;
    wires.subscriptions[topic] = [callback](const std::shared_ptr<const void>& message) {
      const auto typed = std::static_pointer_cast<const Message>(message);
      if constexpr (std::is_invocable_v<Callback, const Message&>) callback(*typed);
      if constexpr (!std::is_invocable_v<Callback, const Message&>) callback(typed);
    };
    return std::make_shared<Subscription<Message>>(topic);
  }
  template <typename Type, typename Callback>
  typename Service<Type>::SharedPtr create_service(const std::string& name, Callback callback) {
    wires.services[name] = [callback](const std::shared_ptr<const void>& response) {
      callback(std::make_shared<typename Type::Request>(),
               std::static_pointer_cast<typename Type::Response>(std::const_pointer_cast<void>(response)));
    };
    return std::make_shared<Service<Type>>();
  }
  template <typename Period>
  TimerBase::SharedPtr create_wall_timer(Period, std::function<void()> callback) {
    wires.timers.push_back(std::move(callback));
    return std::make_shared<TimerBase>();
  }

 private:
  std::string name_;
};

inline void init(int, char**) {}
inline void spin(const std::shared_ptr<Node>&) {
  if (while_spinning) while_spinning();
}
inline bool shutdown() { return true; }

}  // namespace rclcpp

namespace tf2 {

struct TransformException : std::runtime_error {
  using std::runtime_error::runtime_error;
};
inline constexpr std::chrono::time_point<std::chrono::system_clock, std::chrono::nanoseconds> TimePointZero{};

}  // namespace tf2

namespace tf2_ros {

struct Buffer {
  explicit Buffer(const rclcpp::Clock::SharedPtr&) {}
  geometry_msgs::msg::TransformStamped lookupTransform(const std::string& target, const std::string& source,
                                                       decltype(tf2::TimePointZero)) const {
    const auto found = rclcpp::wires.transforms.find({target, source});
    if (found == rclcpp::wires.transforms.end()) throw tf2::TransformException("no transform");
    return found->second;
  }
};
struct TransformListener {
  explicit TransformListener(Buffer&) {}
};
struct TransformBroadcaster {
  explicit TransformBroadcaster(rclcpp::Node&) {}
  void sendTransform(const geometry_msgs::msg::TransformStamped& transform) {
    rclcpp::wires.sent_transforms.push_back(transform);
  }
};

}  // namespace tf2_ros

namespace message_filters {

template <typename Message>
struct PassThrough {
  using Pointer = std::shared_ptr<const Message>;
  void add(const Pointer& message) {
    if (output_) output_(message);
  }
  std::function<void(const Pointer&)> output_;
};

namespace sync_policies {

template <typename First, typename Second>
struct ApproximateTime {
  using FirstPointer = std::shared_ptr<const First>;
  using SecondPointer = std::shared_ptr<const Second>;
  explicit ApproximateTime(std::uint32_t) {}
  void setMaxIntervalDuration(const rclcpp::Duration& interval) { interval_s_ = interval.seconds_; }
  double interval_s_ = 1e9;
};
template <typename First, typename Second>
struct ExactTime : ApproximateTime<First, Second> {
  explicit ExactTime(std::uint32_t depth) : ApproximateTime<First, Second>(depth) { this->interval_s_ = 0; }
};

}  // namespace sync_policies

// Pairs the latest message of each input with the latest one of the other, if their stamps are near enough.
template <typename Policy>
struct Synchronizer : Policy {
  explicit Synchronizer(const Policy& policy) : Policy(policy) {}
  template <typename First, typename Second>
  void connectInput(First& first, Second& second) {
    first.output_ = [this](const auto& message) { first_ = message, join(); };
    second.output_ = [this](const auto& message) { second_ = message, join(); };
  }
  template <typename Callback>
  void registerCallback(const Callback& callback) {
    callback_ = callback;
  }
  void join() {
    if (!first_ || !second_) return;
    const auto stamp = [](const auto& message) { return rclcpp::Time(message.header.stamp).nanoseconds(); };
    const double apart_s = 1e-9 * static_cast<double>(stamp(*first_) - stamp(*second_));
    if (std::abs(apart_s) > Policy::interval_s_) return;
    const auto first = std::move(first_);
    const auto second = std::move(second_);
    callback_(first, second);
  }
  typename Policy::FirstPointer first_;
  typename Policy::SecondPointer second_;
  std::function<void(const typename Policy::FirstPointer&, const typename Policy::SecondPointer&)> callback_;
};

}  // namespace message_filters
