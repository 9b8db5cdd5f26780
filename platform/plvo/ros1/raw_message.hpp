// SPDX-License-Identifier: Apache-2.0
// A message of any type as roscpp receives it, not deserialised, with the stamp and the frame of its header.
// One subscriber then takes images of every transport, whose type the connection names.
#pragma once

#include <ros/message_event.h>
#include <ros/message_traits.h>
#include <ros/serialization.h>
#include <std_msgs/Header.h>

#include <string>

#include "plvo/ros/ros_odometry.hpp"

namespace plvo {

struct RawMessage {
  RosMessage message;
  std_msgs::Header header;  // that the message begins with
};

}  // namespace plvo

// What roscpp wants to know of a type of messages. "*" receives every type.
namespace ros {
namespace message_traits {

template <>
struct IsMessage<plvo::RawMessage> : TrueType {};
template <>
struct MD5Sum<plvo::RawMessage> {
  static const char* value() { return "*"; }
  static const char* value(const plvo::RawMessage&) { return value(); }
};
template <>
struct DataType<plvo::RawMessage> {
  static const char* value() { return "*"; }
  static const char* value(const plvo::RawMessage&) { return value(); }
};
template <>
struct TimeStamp<plvo::RawMessage> {  // message_filters pairs by it
  static ros::Time value(const plvo::RawMessage& raw) { return raw.header.stamp; }
};

}  // namespace message_traits

namespace serialization {

template <>
struct PreDeserialize<plvo::RawMessage> {
  static void notify(const PreDeserializeParams<plvo::RawMessage>& params) {
    const auto type = params.connection_header->find("type");
    if (type != params.connection_header->end()) params.message->message.type = type->second;
  }
};
template <>
struct Serializer<plvo::RawMessage> {
  // roscpp reports the exception of a message that is too short for a header, and drops it.
  static void read(IStream& stream, plvo::RawMessage& raw) {
    raw.message.bytes.assign(stream.getData(), stream.getData() + stream.getLength());
    IStream beginning(raw.message.bytes.data(), static_cast<std::uint32_t>(raw.message.bytes.size()));
    deserialize(beginning, raw.header);
    stream.advance(stream.getLength());
  }
};

}  // namespace serialization
}  // namespace ros
