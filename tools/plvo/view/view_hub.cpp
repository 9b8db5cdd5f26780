// SPDX-License-Identifier: Apache-2.0
#include "plvo/view/view_hub.hpp"

#include <array>
#include <cmath>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <span>

#include "plvo/host/files/stamp_text.hpp"
#include "plvo/host/posix_clock.hpp"
#include "plvo/map/map_limits.hpp"
#include "plvo/replay/images/image_writer.hpp"
#include "plvo/view/view_server.hpp"

namespace plvo {
namespace {

using Json = nlohmann::ordered_json;

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

// Rounds to as many decimals as the page shows or draws, which keeps the text short. JSON has neither NaN nor
// infinity; TrackResult promises none.
double rounded(double value, double per_unit) {
  return std::isfinite(value) ? std::round(value * per_unit) / per_unit : 0;
}
constexpr double kTenths = 10, kHundredths = 100, kTenthMillimetres = 1e4, kNano = 1e9;

Json features_json(const ViewSnapshot& snapshot) {
  Json points = Json::array(), segments = Json::array();
  const auto add = [](Json& list, std::initializer_list<float> pixels, int fate) {
    for (const float pixel : pixels) list.push_back(rounded(static_cast<double>(pixel), kTenths));
    list.push_back(fate);
  };
  for (const ViewSnapshot::Point& p : snapshot.points)
    add(points, {p.u, p.v, p.u_reference, p.v_reference}, static_cast<int>(p.fate));
  for (const ViewSnapshot::Segment& s : snapshot.segments)
    add(segments, {s.a_u, s.a_v, s.b_u, s.b_v}, static_cast<int>(s.fate));
  return {{"points", std::move(points)}, {"segments", std::move(segments)}};
}

Json numbers(std::span<const double> values, double per_unit) {
  Json list = Json::array();
  for (const double value : values) list.push_back(rounded(value, per_unit));
  return list;
}

Json coordinates(const std::vector<Vector3>& points) {
  Json list = Json::array();
  for (const Vector3& point : points)
    for (const double coordinate : point) list.push_back(rounded(coordinate, kTenthMillimetres));
  return list;
}

Json counts_json(const FeatureCounts& counts) {
  return {{"detected", counts.detected}, {"matched", counts.matched}, {"inliers", counts.inliers}};
}

}  // namespace

struct ViewHub::Encoded {
  std::uint64_t image = 0;
  int width = 0, height = 0;
  std::string colour, depth;  // JPEG
  Json features = features_json({});
};

ViewHub::ViewHub() : encoded_(std::make_shared<Encoded>()) { map_way_.reserve(MapLimits::kMostKeyframes); }

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

void ViewHub::publish_map_way(std::span<const Vector3> positions) {
  const std::unique_lock lock(mutex_, std::try_to_lock);
  if (lock) map_way_.assign(positions.begin(), positions.end());  // as in publish()
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
  const int watching = viewers();
  TrackResult r;
  ViewStatus status;
  std::uint64_t path_epoch = 0;
  std::size_t from = 0;
  std::vector<Vector3> path, map_way;  // path: points from index `from` on
  {
    const std::lock_guard lock(mutex_);
    r = result_;
    status = status_;
    path_epoch = path_.epoch();
    const std::vector<Vector3>& points = path_.points();
    if (ask.path_epoch == path_epoch && ask.path_points <= points.size()) from = ask.path_points;
    path.assign(points.begin() + static_cast<std::ptrdiff_t>(from), points.end());
    map_way = map_way_;
  }
  const Quaternion q = to_quaternion(r.T_world_camera.R);
  Json json = {
      {"sequence", sequence},
      {"image", image.image},
      {"size", {image.width, image.height}},
      {"stamp", format_stamp(r.stamp_ns)},
      {"state", to_string(r.state)},
      {"message", r.status.message()},
      {"camera", status.camera},
      {"silent", status.silent},
      {"camera_hz", rounded(status.camera_hz, kHundredths)},
      {"odometry_hz", rounded(status.odometry_hz, kHundredths)},
      {"latency_ms", rounded(status.latency_ms, kHundredths)},
      {"frames", status.frames},
      {"lost", status.lost},
      {"dropped", status.dropped},
      {"viewers", watching},
      {"brightness", rounded(r.mean_brightness, kTenths)},
      {"position", numbers({r.T_world_camera.t.data(), 3}, kNano)},
      {"orientation", numbers(std::array{q.x, q.y, q.z, q.w}, kNano)},
      // Symmetric: row-major equals column-major. Variances have no fixed number of decimals.
      {"covariance", std::vector<double>(r.pose_covariance.data(), r.pose_covariance.data() + 36)},
      {"point_counts", counts_json(r.points)},
      {"line_counts", counts_json(r.lines)},
      {"path_epoch", path_epoch},
      {"path_from", from},
      {"path", coordinates(path)},
  };
  if (status.map)
    json["map"] = {
        {"located", status.map->located}, {"loops", status.map->loops}, {"way", coordinates(map_way)}};
  json.update(image.features);
  return json.dump(-1, ' ', true, Json::error_handler_t::replace);
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
