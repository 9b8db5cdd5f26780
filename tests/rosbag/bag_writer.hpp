// SPDX-License-Identifier: Apache-2.0
// Writes ROS 1 bags without an index, and the messages in them, according to
// http://wiki.ros.org/Bags/Format/2.0.
#pragma once

#include <bzlib.h>
#include <lz4frame.h>

#include <bit>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "plvo/camera/camera_model.hpp"
#include "plvo/image/frame.hpp"
#include "plvo/math/types.hpp"

namespace plvo::test {

inline std::string wire(std::uint64_t number, int bytes) {
  std::string text;
  for (int i = 0; i < bytes; ++i) text += static_cast<char>(number >> (8 * i) & 255);
  return text;
}
inline std::string wire_u32(std::uint64_t number) { return wire(number, 4); }
inline std::string wire_text(const std::string& text) { return wire_u32(text.size()) + text; }
inline std::string wire_f64(double number) { return wire(std::bit_cast<std::uint64_t>(number), 8); }
inline std::string wire_time(std::int64_t ns) {
  return wire_u32(static_cast<std::uint64_t>(ns / 1'000'000'000)) +
         wire_u32(static_cast<std::uint64_t>(ns % 1'000'000'000));
}
inline std::string header_message(std::int64_t stamp_ns) {
  return wire_u32(7) + wire_time(stamp_ns) + wire_text("/openni_rgb_optical_frame");
}

// rows: the bytes in memory, `step` bytes per row.
inline std::string image_message(std::int64_t stamp_ns, int width, int height, const std::string& encoding,
                                 std::size_t step, const std::string& rows, bool big_endian = false) {
  return header_message(stamp_ns) + wire_u32(static_cast<std::uint64_t>(height)) +
         wire_u32(static_cast<std::uint64_t>(width)) + wire_text(encoding) + (big_endian ? '\1' : '\0') +
         wire_u32(step) + wire_text(rows);
}
inline std::string colour_message(const RgbdFrame& frame) {
  const ColourView& c = frame.colour;
  const auto bytes = static_cast<std::size_t>(c.stride_bytes) * static_cast<std::size_t>(c.height);
  return image_message(frame.stamp_ns, c.width, c.height, "rgb8", static_cast<std::size_t>(c.stride_bytes),
                       {reinterpret_cast<const char*>(c.data), bytes});
}
// 16UC1 is copied; 32FC1 is in metres, with NaN for missing depth.
inline std::string depth_message(const RgbdFrame& frame, bool metres) {
  const DepthView& d = frame.depth;
  std::string rows;
  for (int y = 0; y < d.height; ++y)
    for (int x = 0; x < d.width; ++x) {
      const std::uint16_t units = d.data[y * d.stride + x];
      const float z =
          units == 0 ? std::bit_cast<float>(0x7fc00000u) : static_cast<float>(units * d.metres_per_unit);
      rows += metres ? wire_u32(std::bit_cast<std::uint32_t>(z)) : wire(units, 2);
    }
  return image_message(frame.depth_stamp_ns, d.width, d.height, metres ? "32FC1" : "16UC1",
                       static_cast<std::size_t>(d.width) * (metres ? 4 : 2), rows);
}
inline std::string camera_info_message(std::int64_t stamp_ns, const CameraModel& camera,
                                       const std::string& model = "plumb_bob",
                                       const std::vector<double>& D = {0, 0, 0, 0, 0}) {
  std::string text = header_message(stamp_ns) + wire_u32(static_cast<std::uint64_t>(camera.height)) +
                     wire_u32(static_cast<std::uint64_t>(camera.width)) + wire_text(model) +
                     wire_u32(D.size());
  for (const double d : D) text += wire_f64(d);
  const Pinhole& p = camera.pinhole;
  for (const double k : {p.fx, 0.0, p.cx, 0.0, p.fy, p.cy, 0.0, 0.0, 1.0}) text += wire_f64(k);
  for (const double r : {1, 0, 0, 0, 1, 0, 0, 0, 1}) text += wire_f64(r);
  for (int i = 0; i < 12; ++i) text += wire_f64(0);
  return text + std::string(4 + 4 + 4 * 4 + 1, '\0');  // binning and region of interest
}

// As in ROS, a missing value has a covariance that begins with -1.
inline std::string imu_message(std::int64_t stamp_ns, const Vector3& rate, bool has_rate,
                               const Vector3& force, bool has_force) {
  const auto covariance = [](bool there) {
    std::string text = wire_f64(there ? 0.01 : -1);
    for (int i = 1; i < 9; ++i) text += wire_f64(0);
    return text;
  };
  const auto vector = [](const Vector3& v) { return wire_f64(v.x()) + wire_f64(v.y()) + wire_f64(v.z()); };
  std::string orientation;
  for (const double q : {0, 0, 0, 1}) orientation += wire_f64(q);
  return header_message(stamp_ns) + orientation + covariance(false) + vector(rate) + covariance(has_rate) +
         vector(force) + covariance(has_force);
}

class BagWriter {
 public:
  using Fields = std::vector<std::pair<std::string, std::string>>;
  static std::string record(const Fields& fields, const std::string& data) {
    std::string header;
    for (const auto& [name, value] : fields) header += wire_text(name + '=' + value);
    return wire_text(header) + wire_text(data);
  }

  void connection(std::uint32_t number, const std::string& topic, const std::string& type) {
    connections_ += record({{"op", "\7"}, {"conn", wire_u32(number)}, {"topic", topic}},
                           wire_text("type=" + type) + wire_text("md5sum=*"));
    chunk_ += connections_.substr(written_connections_);
    written_connections_ = connections_.size();
  }
  void message(std::uint32_t connection, std::int64_t received_ns, const std::string& data) {
    chunk_ += record({{"op", "\2"}, {"conn", wire_u32(connection)}, {"time", wire_time(received_ns)}}, data);
  }
  // The beginning of a chunk that states its packed and its unpacked size.
  static std::string claim(const std::string& compression, std::uint32_t unpacked, std::uint32_t packed) {
    const std::string chunk =
        record({{"op", "\5"}, {"compression", compression}, {"size", wire_u32(unpacked)}}, "");
    return chunk.substr(0, chunk.size() - 4) + wire_u32(packed);
  }
  // Adds a record unchanged.
  void put(const std::string& record) { chunk_ += record; }
  // Packs everything since the last chunk; `compression` is the name in the bag.
  void end_chunk(const std::string& compression = "none") { put_chunks(packed_chunk(compression)); }
  void put_chunks(const std::string& chunks) { body_ += chunks; }
  std::string packed_chunk(const std::string& compression) {
    std::string packed = chunk_;
    if (compression == "bz2") {
      auto size = static_cast<unsigned>(chunk_.size() + chunk_.size() / 50 + 1000);
      packed.resize(size);
      BZ2_bzBuffToBuffCompress(packed.data(), &size, chunk_.data(), static_cast<unsigned>(chunk_.size()), 9,
                               0, 0);
      packed.resize(size);
    } else if (compression == "lz4") {
      packed.resize(LZ4F_compressFrameBound(chunk_.size(), nullptr));
      packed.resize(LZ4F_compressFrame(packed.data(), packed.size(), chunk_.data(), chunk_.size(), nullptr));
    }
    const std::string size = wire_u32(chunk_.size());
    chunk_.clear();
    return record({{"op", "\5"}, {"compression", compression}, {"size", size}}, packed);
  }
  // Returns the bag with everything so far. If not closed, the last chunk has no length yet, as after a crash
  // of the recorder.
  std::string file(bool closed = true) const {
    const std::string magic = "#ROSBAG V2.0\n";
    std::string header;
    const auto make_header = [&](std::uint64_t index) {
      header = record({{"op", "\3"}, {"index_pos", wire(index, 8)}, {"conn_count", wire_u32(1)}},
                      std::string(100, ' '));
    };
    make_header(0);
    if (!closed)
      return magic + header + body_ +
             record({{"op", "\5"}, {"compression", "none"}, {"size", wire_u32(0)}}, "") + chunk_;
    make_header(magic.size() + header.size() + body_.size());
    return magic + header + body_ + connections_;
  }

 private:
  std::string body_, chunk_, connections_;
  std::size_t written_connections_ = 0;
};

}  // namespace plvo::test
