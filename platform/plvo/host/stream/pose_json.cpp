// SPDX-License-Identifier: Apache-2.0
#include "plvo/host/stream/pose_json.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <iterator>
#include <span>

namespace plvo {
namespace {

// Written by hand: a JSON library would be a dependency of the smallest robot program (plvo_host) for two
// lines of fixed members, and would write 17 digits where nine are meaningful.

// JSON has no infinity and no NaN; TrackResult promises neither, and null says so if it is broken.
void put_number(std::string& to, double value) {
  if (std::isfinite(value)) {
    fmt::format_to(std::back_inserter(to), "{:.9g}", value);
  } else {
    to += "null";
  }
}

void put_counts(std::string& to, const char* name, const FeatureCounts& counts) {
  fmt::format_to(std::back_inserter(to),
                 ",\"{}\":{{\"detected\":{},\"dropped\":{},\"with_depth\":{},\"matched\":{},\"inliers\":{}}}",
                 name, counts.detected, counts.dropped, counts.with_depth, counts.matched, counts.inliers);
}

// The text within quotes, with what JSON forbids escaped; bytes that are not ASCII become "?".
std::string json_string(std::string_view text) {
  std::string out = "\"";
  for (char c : text) {
    if (c == '"' || c == '\\') {
      out += '\\';
      out += c;
    } else if (c < ' ' || c == 0x7f) {  // also every byte above 127, where char is signed
      out += c == '\n' || c == '\t' ? ' ' : '?';
    } else {
      out += static_cast<unsigned char>(c) > 126 ? '?' : c;
    }
  }
  return out + '"';
}

void put_numbers(std::string& to, const char* name, std::span<const double> values) {
  fmt::format_to(std::back_inserter(to), ",\"{}\":[", name);
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (i > 0) to += ',';
    put_number(to, values[i]);
  }
  to += ']';
}

void put_pose(std::string& to, const Se3& T, const Matrix6& covariance) {
  put_numbers(to, "position", {T.t.data(), 3});
  const Quaternion q = to_quaternion(T.R);
  put_numbers(to, "orientation_xyzw", std::array{q.x, q.y, q.z, q.w});
  // Symmetric: row-major equals column-major.
  put_numbers(to, "covariance", {covariance.data(), 36});
}

void put_map(std::string& to, const MapPose& map) {
  fmt::format_to(std::back_inserter(to), ",\"map\":{{\"located\":{},\"loops\":{}", map.located, map.loops);
  if (map.located) {
    put_pose(to, map.T_map_world, map.pose_covariance);
  } else {
    to += ",\"position\":null,\"orientation_xyzw\":null,\"covariance\":null";
  }
  to += '}';
}

}  // namespace

std::string pose_json(const TrackResult& result, const FrameNames& frames, const MapPose* map) {
  std::string out = fmt::format(
      "{{\"stamp_ns\":{},\"state\":\"{}\",\"status\":\"{}\",\"message\":{},\"world\":{},\"frame_id\":\"{}\","
      "\"child_frame_id\":\"{}\"",
      result.stamp_ns, to_string(result.state), to_string(result.status.code()),
      json_string(result.status.message()), result.world, frames.world, frames.body);
  put_pose(out, result.T_world_camera, result.pose_covariance);
  put_counts(out, "points", result.points);
  put_counts(out, "lines", result.lines);
  if (map != nullptr) put_map(out, *map);
  out += '}';
  return out;
}

std::string heartbeat_json(const Heartbeat& heartbeat) {
  const bool came = heartbeat.seconds_since_frame >= 0;
  return fmt::format("{{\"heartbeat\":true,\"state\":{},\"seconds_since_frame\":{},\"message\":{}}}",
                     json_string(heartbeat.state),
                     came ? fmt::format("{:.3f}", heartbeat.seconds_since_frame) : "null",
                     json_string(heartbeat.message));
}

}  // namespace plvo
