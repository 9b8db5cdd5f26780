// SPDX-License-Identifier: Apache-2.0
#include "plvo/view/view_hub.hpp"

#include <fmt/format.h>

#include <cmath>
#include <iterator>

#include "plvo/host/files/stamp_text.hpp"
#include "plvo/host/posix_clock.hpp"
#include "plvo/host/stream/pose_json.hpp"
#include "plvo/replay/images/image_writer.hpp"
#include "plvo/view/view_server.hpp"

namespace plvo {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000;
constexpr std::int64_t kIdle_ns = 3 * kSecond;  // after this time without a request there are no viewers
constexpr std::size_t kMaxKnownViewers = 64;
constexpr int kJpegQuality = 75;

void put_part(std::string& to, std::string_view part) {
  for (int i = 0; i < 4; ++i) to += static_cast<char>((part.size() >> (8 * i)) & 0xff);
  to += part;
}

std::string jpeg(const std::uint8_t* pixels, int width, int height, PixelFormat format) {
  if (width <= 0 || height <= 0) return {};
  const int bytes = format == PixelFormat::kGray8 ? 1 : 3;
  const std::vector<std::uint8_t> data =
      encode_jpeg({pixels, width, height, width * bytes, format}, kJpegQuality);
  return {data.begin(), data.end()};
}

std::string features_json(const ViewSnapshot& snapshot) {
  std::string out = "\"points\":[";
  const char* comma = "";
  for (const ViewSnapshot::Point& p : snapshot.points) {
    fmt::format_to(std::back_inserter(out), "{}{:.1f},{:.1f},{:.1f},{:.1f},{}", comma, p.u, p.v,
                   p.u_reference, p.v_reference, static_cast<int>(p.fate));
    comma = ",";
  }
  out += "],\"segments\":[";
  comma = "";
  for (const ViewSnapshot::Segment& s : snapshot.segments) {
    fmt::format_to(std::back_inserter(out), "{}{:.1f},{:.1f},{:.1f},{:.1f},{}", comma, s.a_u, s.a_v, s.b_u,
                   s.b_v, static_cast<int>(s.fate));
    comma = ",";
  }
  return out + "]";
}

void put_array(std::string& to, const char* name, const double* values, int count) {
  fmt::format_to(std::back_inserter(to), ",\"{}\":[", name);
  for (int i = 0; i < count; ++i) {
    fmt::format_to(std::back_inserter(to), "{}{:.6g}", i > 0 ? "," : "",
                   std::isfinite(values[i]) ? values[i] : 0.0);
  }
  to += ']';
}

void put_counts(std::string& to, const char* name, const FeatureCounts& counts) {
  fmt::format_to(std::back_inserter(to), ",\"{}\":{{\"detected\":{},\"matched\":{},\"inliers\":{}}}", name,
                 counts.detected, counts.matched, counts.inliers);
}

}  // namespace

void ViewHub::publish(const RgbdFrame& frame, const FeatureView& features, const TrackResult& result,
                      const ViewStatus& status, bool lens_is_straight) {
  const std::int64_t now = posix_monotonic_ns();
  const bool watched = now - last_ask_ns_ < kIdle_ns;
  const bool with_image = watched && now - last_image_ns_ >= kSecond / ViewServer::kMaxRate;
  if (with_image) {
    // Only this thread uses back_ until the swap below.
    ViewSnapshot& snapshot = snapshots_[static_cast<std::size_t>(back_)];
    snapshot.copy_images(frame, features, lens_is_straight);
    snapshot.copy_features(features);
  }
  {
    const std::unique_lock lock(mutex_, std::try_to_lock);
    if (!lock) return;  // never wait for a viewer's thread, which may be preempted: the next frame is shown
    result_ = result;
    status_ = status;
    if (result.state != TrackState::kLost) path_.add(result.T_world_camera.t);
    if (with_image) {
      snapshots_[static_cast<std::size_t>(back_)].image_sequence = ++image_sequence_;
      std::swap(back_, middle_);
      middle_is_new_ = true;
      ++sequence_;
      last_image_ns_ = now;
    }
  }
  if (with_image) on_news_();
}

void ViewHub::publish_status(const ViewStatus& status) {
  {
    const std::lock_guard lock(mutex_);
    status_ = status;
    ++sequence_;
  }
  on_news_();
}

int ViewHub::viewers() const {
  const std::lock_guard lock(mutex_);
  const std::int64_t now = posix_monotonic_ns();
  int count = 0;
  for (const auto& [name, when] : seen_) count += now - when < kIdle_ns ? 1 : 0;
  return count;
}

std::uint64_t ViewHub::images() const {
  const std::lock_guard lock(mutex_);
  return image_sequence_;
}

void ViewHub::count_viewer(const Ask& ask) {
  const std::lock_guard lock(mutex_);
  const std::int64_t now = posix_monotonic_ns();
  last_ask_ns_ = now;
  std::erase_if(seen_, [now](const auto& entry) { return now - entry.second >= kIdle_ns; });
  const std::string viewer = ask.viewer.substr(0, 32);
  if (seen_.size() < kMaxKnownViewers || seen_.count(viewer) != 0) seen_[viewer] = now;
}

// A sequence number above the current one comes from an earlier run of the program: everything is news.
bool ViewHub::has_news(const Ask& ask) const {
  const std::lock_guard lock(mutex_);
  return sequence_ != ask.after;
}

std::shared_ptr<const ViewHub::Encoded> ViewHub::encoded() {
  const std::lock_guard encoding(encode_mutex_);
  {
    const std::lock_guard lock(mutex_);
    if (!middle_is_new_) return encoded_;
    std::swap(front_, middle_);
    middle_is_new_ = false;
  }
  const ViewSnapshot& snapshot = snapshots_[static_cast<std::size_t>(front_)];
  auto fresh = std::make_shared<Encoded>();
  fresh->image = snapshot.image_sequence;
  fresh->width = snapshot.width;
  fresh->height = snapshot.height;
  fresh->colour = jpeg(snapshot.pixels.data(), snapshot.width, snapshot.height, snapshot.format);
  std::vector<std::uint8_t> rgb;
  int width = 0, height = 0;
  paint_depth(snapshot, rgb, width, height);
  fresh->depth = jpeg(rgb.data(), width, height, PixelFormat::kRgb8);
  fresh->features = features_json(snapshot);
  encoded_ = fresh;
  ++encodings_;
  return encoded_;
}

std::string ViewHub::state_json(const Ask& ask, std::uint64_t sequence, const Encoded& image) {
  std::string out;
  const int watching = viewers();
  TrackResult r;
  ViewStatus status;
  std::uint64_t path_epoch = 0;
  std::size_t from = 0;
  std::vector<Vector3> path;  // points from index `from` on
  {
    const std::lock_guard lock(mutex_);
    r = result_;
    status = status_;
    path_epoch = path_.epoch();
    const std::vector<Vector3>& points = path_.points();
    if (ask.path_epoch == path_epoch && ask.path_points <= points.size()) from = ask.path_points;
    path.assign(points.begin() + static_cast<std::ptrdiff_t>(from), points.end());
  }
  const Quaternion q = to_quaternion(r.T_world_camera.R);
  const std::array<double, 4> orientation{q.x, q.y, q.z, q.w};
  fmt::format_to(
      std::back_inserter(out),
      "{{\"sequence\":{},\"image\":{},\"size\":[{},{}],\"stamp\":\"{}\",\"state\":\"{}\",\"message\":{},"
      "\"camera\":{},\"silent\":{},\"camera_hz\":{:.2f},\"odometry_hz\":{:.2f},\"latency_ms\":{:.2f},"
      "\"frames\":{},"
      "\"lost\":{},\"dropped\":{},\"viewers\":{},\"brightness\":{:.1f}",
      sequence, image.image, image.width, image.height, format_stamp(r.stamp_ns), to_string(r.state),
      json_string(r.status.message()), json_string(status.camera), status.silent, status.camera_hz,
      status.odometry_hz, status.latency_ms, status.frames, status.lost, status.dropped, watching,
      r.mean_brightness);
  put_array(out, "position", r.T_world_camera.t.data(), 3);
  put_array(out, "orientation", orientation.data(), 4);
  put_array(out, "covariance", r.pose_covariance.data(), 36);  // symmetric: row-major equals column-major
  put_counts(out, "point_counts", r.points);
  put_counts(out, "line_counts", r.lines);
  fmt::format_to(std::back_inserter(out), ",\"path_epoch\":{},\"path_from\":{},\"path\":[", path_epoch, from);
  const char* comma = "";
  for (const Vector3& point : path) {
    fmt::format_to(std::back_inserter(out), "{}{:.4f},{:.4f},{:.4f}", comma, point.x(), point.y(), point.z());
    comma = ",";
  }
  return out + "]," + image.features + "}";
}

std::string ViewHub::reply(const Ask& ask) {
  std::uint64_t sequence = 0;
  {
    // Read the number before the image: an image that arrives in between is then news again.
    const std::lock_guard lock(mutex_);
    sequence = sequence_;
  }
  if (sequence == ask.after) return {};
  const std::shared_ptr<const Encoded> image = encoded();
  std::string out;
  put_part(out, state_json(ask, sequence, *image));
  const bool has_it = image->image == ask.image;
  put_part(out, has_it ? std::string_view() : image->colour);
  put_part(out, has_it ? std::string_view() : image->depth);
  ++replies_;
  return out;
}

}  // namespace plvo
