// SPDX-License-Identifier: Apache-2.0
#include "plvo/host/stream/pose_json.hpp"

#include <fmt/format.h>

#include <cmath>
#include <iterator>

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

}  // namespace

std::string pose_json(const TrackResult& result, const FrameNames& frames) {
  std::string out = fmt::format(
      "{{\"stamp_ns\":{},\"state\":\"{}\",\"status\":\"{}\",\"message\":{},\"frame_id\":\"{}\","
      "\"child_frame_id\":\"{}\",\"position\":[",
      result.stamp_ns, to_string(result.state), to_string(result.status.code()),
      json_string(result.status.message()), frames.world, frames.body);
  for (int i = 0; i < 3; ++i) {
    if (i > 0) out += ',';
    put_number(out, result.T_world_camera.t[i]);
  }
  out += "],\"orientation_xyzw\":[";
  const Quaternion q = to_quaternion(result.T_world_camera.R);
  int n = 0;
  for (double value : {q.x, q.y, q.z, q.w}) {
    if (n++ > 0) out += ',';
    put_number(out, value);
  }
  out += "],\"covariance\":[";
  for (int i = 0; i < 36; ++i) {
    if (i > 0) out += ',';
    put_number(out, result.pose_covariance(i / 6, i % 6));
  }
  out += ']';
  put_counts(out, "points", result.points);
  put_counts(out, "lines", result.lines);
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
