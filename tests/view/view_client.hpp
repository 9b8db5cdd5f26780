// SPDX-License-Identifier: Apache-2.0
// Both sides of the live view: synthetic frames for the server, a browser's requests over real sockets, and a
// viewer that keeps requesting until it has the desired image. No check depends on time.
#pragma once

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <condition_variable>
#include <cstdlib>
#include <mutex>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "loopback.hpp"
#include "plvo/view/view_server.hpp"

namespace plvo::test {

// The camera image, depth and features of a synthetic frame.
struct Scene {
  int width = 64, height = 48;
  std::vector<std::uint8_t> colour, gray;
  std::vector<std::uint16_t> depth;
  std::vector<Keypoint> keypoints = std::vector<Keypoint>(3);
  std::vector<SegmentView> segments{{1, 2, 3, 4, false}, {5, 6, 7, 8, true}, {9, 9, 9, 20, true}};
  std::vector<PointTrackView> tracks{{10, 11, 12, 13, true}, {20, 21, 22, 23, false}};
  std::vector<LineTrackView> lines{{0, 2, true}};
  int number = 0;

  explicit Scene(int w = 64, int h = 48) : width(w), height(h) {
    const auto pixels = static_cast<std::size_t>(w) * static_cast<std::size_t>(h);
    gray.assign(pixels, 120);
    depth.assign(pixels, 1500);
    colour.resize(pixels * 3);
    // Noise has the largest possible JPEG.
    std::uint32_t state = 1;
    for (std::uint8_t& value : colour)
      value = static_cast<std::uint8_t>((state = state * 1664525 + 1013904223) >> 24);
  }
  RgbdFrame frame() {
    RgbdFrame f;
    f.stamp_ns = f.depth_stamp_ns = ++number * 33'000'000LL;
    f.colour = {colour.data(), width, height, width * 3, PixelFormat::kRgb8};
    f.depth = {depth.data(), width, height, width, 0.001};
    return f;
  }
  FeatureView features() const {
    FeatureView view;
    view.image = {gray.data(), width, height, width};
    view.keypoints = keypoints;
    view.segments = segments;
    view.point_tracks = tracks;
    view.line_tracks = lines;
    return view;
  }
  TrackResult result() const {
    TrackResult r;
    r.state = TrackState::kTracking;
    r.stamp_ns = number * 33'000'000LL;
    r.T_world_camera.t = Vector3(0.01 * number, 0, 0);
    r.pose_covariance = Matrix6::Identity() * 1e-4;
    return r;
  }
  void publish_to(ViewServer& server) { server.publish(frame(), features(), result(), {}, true); }
};

inline int connect_to(int port) {
  const int fd = connect_loopback(port);
  const timeval limit{120, 0};  // a hanging test fails with a message
  ::setsockopt(fd, SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof limit);
  return fd;
}
// Returns false once the server has closed the connection.
inline bool send_text(int fd, const std::string& text, int flags = 0) {
  return ::send(fd, text.data(), text.size(), MSG_NOSIGNAL | flags) == static_cast<ssize_t>(text.size());
}
inline std::string read_to_end(int fd) {
  std::string reply;
  std::array<char, 8192> bytes{};
  for (ssize_t got = 0; (got = ::read(fd, bytes.data(), bytes.size())) > 0;) {
    reply.append(bytes.data(), static_cast<std::size_t>(got));
  }
  return reply;
}
inline std::string host_header(int port, const std::string& name = "localhost") {
  return "Host: " + name + ':' + std::to_string(port) + "\r\n";
}
// Returns the complete reply to these bytes, as text.
inline std::string reply_to(int port, const std::string& bytes) {
  const int fd = connect_to(port);
  send_text(fd, bytes);
  std::string reply = read_to_end(fd);
  ::close(fd);
  return reply;
}
// headers: with their line ends.
inline std::string request(int port, const std::string& first_line, const std::string& headers) {
  return reply_to(port, first_line + " HTTP/1.1\r\n" + headers + "Connection: close\r\n\r\n");
}
inline std::string get(int port, const std::string& path) {
  return request(port, "GET " + path, host_header(port));
}
inline int status_of(const std::string& reply) {
  return reply.rfind("HTTP/1.1 ", 0) == 0 ? std::atoi(reply.c_str() + 9) : 0;
}
inline std::string body(const std::string& reply) {
  const std::size_t end = reply.find("\r\n\r\n");
  return end == std::string::npos ? "" : reply.substr(end + 4);
}

struct Update {
  nlohmann::json state;
  std::string colour, depth;
};
inline bool parse_update(const std::string& text, Update& update) {
  std::vector<std::string> parts;
  for (std::size_t at = 0; at + 4 <= text.size();) {
    std::size_t size = 0;
    for (std::size_t i = 0; i < 4; ++i)
      size |= static_cast<std::size_t>(static_cast<unsigned char>(text[at + i])) << (8 * i);
    parts.push_back(text.substr(at + 4, size));
    at += 4 + size;
  }
  if (parts.size() != 3) return false;
  update = {nlohmann::json::parse(parts[0]), parts[1], parts[2]};
  return true;
}
inline std::string ask(const Update& last, const std::string& viewer) {
  if (last.state.is_null()) return "/update?after=0&image=0&viewer=" + viewer;
  return "/update?after=" + last.state["sequence"].dump() + "&image=" + last.state["image"].dump() +
         "&epoch=" + last.state["path_epoch"].dump() + "&path=" +
         std::to_string(last.state["path_from"].get<int>() +
                        static_cast<int>(last.state["path"].size() / 3)) +
         "&viewer=" + viewer;
}

// Sends requests repeatedly over one connection, as a browser does, and keeps the numbers of the images that
// came with pixels. It reconnects if a connection ends.
class Viewer {
 public:
  Viewer(int port, std::string name) : port_(port), name_(std::move(name)), thread_([this] { run(); }) {}
  ~Viewer() { stop(); }
  // A pending request ends by itself: the server answers within a second.
  void stop() {
    stop_ = true;
    if (thread_.joinable()) thread_.join();
  }
  // Waits until this image, or a later one, has arrived.
  void wait_for(std::uint64_t image) {
    std::unique_lock lock(mutex_);
    came_.wait(lock, [&] { return !images_.empty() && images_.back() >= image; });
  }
  std::vector<std::uint64_t> images() const {
    const std::lock_guard lock(mutex_);
    return images_;
  }
  int connections() const { return connections_; }  // number of connections it used

 private:
  // Returns the body of the reply; empty if the connection ended.
  std::string fetch(const std::string& path) {
    if (fd_ < 0) {
      fd_ = connect_to(port_);
      ++connections_;
    }
    send_text(fd_, "GET " + path + " HTTP/1.1\r\n" + host_header(port_) + "\r\n");
    std::string reply;
    std::array<char, 8192> bytes{};
    for (std::size_t want = std::string::npos; reply.size() < want;) {
      const ssize_t got = ::read(fd_, bytes.data(), bytes.size());
      if (got <= 0) {
        ::close(fd_);
        fd_ = -1;
        return "";
      }
      reply.append(bytes.data(), static_cast<std::size_t>(got));
      const std::size_t end = reply.find("\r\n\r\n");
      const std::size_t length = reply.find("Content-Length: ");
      if (end != std::string::npos && length < end)
        want = end + 4 + static_cast<std::size_t>(std::atol(reply.c_str() + length + 16));
    }
    return body(reply);
  }
  void run() {
    Update last;
    while (!stop_) {
      if (!parse_update(fetch(ask(last, name_)), last) || last.colour.empty()) continue;
      const std::lock_guard lock(mutex_);
      images_.push_back(last.state["image"]);
      came_.notify_all();
    }
    if (fd_ >= 0) ::close(fd_);
  }
  const int port_;
  const std::string name_;
  int fd_ = -1;
  std::atomic<int> connections_{0};
  std::atomic<bool> stop_{false};
  mutable std::mutex mutex_;
  std::condition_variable came_;
  std::vector<std::uint64_t> images_;
  std::thread thread_;
};

// Publishes until the server has copied one more image for the viewers; returns its number. Never returns
// without a viewer.
inline std::uint64_t publish_one(Scene& scene, ViewServer& server) {
  const std::uint64_t before = server.images();
  while (server.images() == before) {
    scene.publish_to(server);
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return server.images();
}

}  // namespace plvo::test
