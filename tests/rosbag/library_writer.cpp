// SPDX-License-Identifier: Apache-2.0
#include "library_writer.hpp"

#include <rosbag/bag.h>

#include <boost/make_shared.hpp>
#include <cstring>

namespace {

// A message that is already serialised; the connection header states its type.
struct Bytes {
  const plvo::test::RecordedMessage* message = nullptr;
};

}  // namespace

namespace ros {
namespace message_traits {
template <>
struct MD5Sum<Bytes> {
  static const char* value(const Bytes&) { return "*"; }
};
template <>
struct DataType<Bytes> {
  static const char* value(const Bytes& bytes) { return bytes.message->type.c_str(); }
};
template <>
struct Definition<Bytes> {
  static const char* value(const Bytes&) { return "of no interest"; }
};
}  // namespace message_traits
namespace serialization {
template <>
struct Serializer<Bytes> {
  template <typename Stream>
  static void write(Stream& stream, const Bytes& bytes) {
    const std::string& data = bytes.message->data;
    std::memcpy(stream.advance(static_cast<std::uint32_t>(data.size())), data.data(), data.size());
  }
  static std::uint32_t serializedLength(const Bytes& bytes) {
    return static_cast<std::uint32_t>(bytes.message->data.size());
  }
};
}  // namespace serialization
}  // namespace ros

namespace plvo::test {

bool write_bag_with_library(const std::string& path, const std::string& compression,
                            const std::vector<RecordedMessage>& messages, std::string& error) {
  try {
    rosbag::Bag bag(path, rosbag::bagmode::Write);
    bag.setCompression(compression == "bz2" ? rosbag::compression::BZ2
                                            : (compression == "lz4" ? rosbag::compression::LZ4
                                                                    : rosbag::compression::Uncompressed));
    for (const RecordedMessage& message : messages) {
      const ros::Time received(static_cast<std::uint32_t>(message.received_ns / 1'000'000'000),
                               static_cast<std::uint32_t>(message.received_ns % 1'000'000'000));
      bag.write(message.topic, received, Bytes{&message});
    }
    bag.close();
    return true;
  } catch (const std::exception& exception) {
    error = exception.what();
    return false;
  }
}

}  // namespace plvo::test
