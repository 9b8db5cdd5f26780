// SPDX-License-Identifier: Apache-2.0
// The live view's server, with real sockets: what a viewer gets, several of them, and those that never read,
// vanish, or come in under a strange name. The odometry's side must not notice.
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "plvo/host/posix_clock.hpp"
#include "plvo/view/view_server.hpp"

namespace plvo {
namespace {

constexpr int kWidth = 64, kHeight = 48;

// A camera image, depth, and features of a make-believe frame.
struct Scene {
  std::vector<std::uint8_t> colour = std::vector<std::uint8_t>(kWidth * kHeight * 3, 90);
  std::vector<std::uint16_t> depth = std::vector<std::uint16_t>(kWidth * kHeight, 1500);
  std::vector<std::uint8_t> gray = std::vector<std::uint8_t>(kWidth * kHeight, 120);
  std::vector<Keypoint> keypoints = std::vector<Keypoint>(3);
  std::vector<SegmentView> segments{{1, 2, 3, 4, false}, {5, 6, 7, 8, true}, {9, 9, 9, 20, true}};
  std::vector<PointTrackView> tracks{{10, 11, 12, 13, true}, {20, 21, 22, 23, false}};
  std::vector<LineTrackView> lines{{0, 2, true}};
  int number = 0;

  RgbdFrame frame() {
    RgbdFrame f;
    f.stamp_ns = f.depth_stamp_ns = ++number * 33'000'000LL;
    f.colour = {colour.data(), kWidth, kHeight, kWidth * 3, PixelFormat::kRgb8};
    f.depth = {depth.data(), kWidth, kHeight, kWidth, 0.001};
    return f;
  }
  FeatureView features() const {
    FeatureView view;
    view.image = {gray.data(), kWidth, kHeight, kWidth};
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
};

int connect_to(int port) {
  const int fd = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_port = htons(static_cast<std::uint16_t>(port));
  to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  EXPECT_EQ(::connect(fd, reinterpret_cast<const sockaddr*>(&to), sizeof to), 0);
  const timeval limit{10, 0};
  ::setsockopt(fd, SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof limit);
  return fd;
}
void send_text(int fd, const std::string& text) {
  EXPECT_EQ(::send(fd, text.data(), text.size(), MSG_NOSIGNAL), static_cast<ssize_t>(text.size()));
}
std::string get(int port, const std::string& path, const std::string& host = "localhost") {
  const int fd = connect_to(port);
  send_text(fd, "GET " + path + " HTTP/1.1\r\nHost: " + host + "\r\nConnection: close\r\n\r\n");
  std::string reply;
  std::array<char, 8192> bytes{};
  for (ssize_t got = 0; (got = ::read(fd, bytes.data(), bytes.size())) > 0;) {
    reply.append(bytes.data(), static_cast<std::size_t>(got));
  }
  ::close(fd);
  return reply;
}
std::string body(const std::string& reply) { return reply.substr(reply.find("\r\n\r\n") + 4); }

struct Update {
  nlohmann::json state;
  std::string colour, depth;
};
bool parse_update(const std::string& text, Update& update) {
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
std::string ask(const Update& last, const std::string& viewer) {
  if (last.state.is_null()) return "/update?after=0&image=0&viewer=" + viewer;
  return "/update?after=" + last.state["sequence"].dump() + "&image=" + last.state["image"].dump() +
         "&epoch=" + last.state["path_epoch"].dump() + "&path=" +
         std::to_string(last.state["path_from"].get<int>() +
                        static_cast<int>(last.state["path"].size() / 3)) +
         "&viewer=" + viewer;
}

class LiveView : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!ViewServer::available()) GTEST_SKIP() << "built without cpp-httplib";
    const Status status = server_.start("127.0.0.1", 0);
    ASSERT_TRUE(status.ok()) << status.message();
  }
  // Publishes at 30 Hz until the test ends, and remembers the longest publish().
  void run_odometry() {
    odometry_ = std::thread([this] {
      while (!stop_) {
        const RgbdFrame frame = scene_.frame();
        const std::int64_t start = posix_monotonic_ns();
        server_.publish(frame, scene_.features(), scene_.result(), {}, true);
        longest_ns_ = std::max<std::int64_t>(longest_ns_, posix_monotonic_ns() - start);
        std::this_thread::sleep_for(std::chrono::milliseconds(33));
      }
    });
  }
  void TearDown() override {
    stop_ = true;
    if (odometry_.joinable()) odometry_.join();
    server_.stop();
  }

  Scene scene_;
  ViewServer server_;
  std::thread odometry_;
  std::atomic<bool> stop_{false};
  std::atomic<std::int64_t> longest_ns_{0};
};

TEST_F(LiveView, ThePageIsOneFileThatMayNotLoadOthers) {
  const std::string reply = get(server_.port(), "/");
  EXPECT_NE(reply.find("200 OK"), std::string::npos);
  EXPECT_NE(reply.find("default-src 'none'"), std::string::npos);
  EXPECT_NE(reply.find("<canvas id=\"space\""), std::string::npos);
  EXPECT_EQ(reply.find("http://"), std::string::npos);
  EXPECT_EQ(reply.find("https://"), std::string::npos);
}

TEST_F(LiveView, AnUpdateHoldsStateFeaturesAndPictures) {
  run_odometry();
  Update update;
  while (update.colour.empty()) {
    const std::string reply = get(server_.port(), ask(update, "one"));
    ASSERT_NE(reply.find("200 OK"), std::string::npos) << reply;
    parse_update(body(reply), update);
  }
  EXPECT_EQ(update.colour.substr(0, 3), "\xff\xd8\xff");  // JPEG
  EXPECT_EQ(update.depth.substr(0, 3), "\xff\xd8\xff");
  EXPECT_EQ(update.state["state"], "tracking");
  EXPECT_EQ(update.state["size"], nlohmann::json({kWidth, kHeight}));
  EXPECT_EQ(update.state["covariance"].size(), 36u);
  ASSERT_EQ(update.state["points"].size(), 5u * 5);
  EXPECT_EQ(update.state["points"][15], 12.0);  // the first track: here, there, inlier
  EXPECT_EQ(update.state["points"][17], 10.0);
  EXPECT_EQ(update.state["points"][19], 3);
  EXPECT_EQ(update.state["points"][24], 2);
  ASSERT_EQ(update.state["segments"].size(), 3u * 5);
  EXPECT_EQ(update.state["segments"][4], 0);   // seen
  EXPECT_EQ(update.state["segments"][9], 1);   // with depth
  EXPECT_EQ(update.state["segments"][14], 3);  // inlier
  EXPECT_GE(update.state["path"].size(), 3u);
}

TEST_F(LiveView, TenUpdatesASecondForEachOfThreeViewersFromOneEncoding) {
  run_odometry();
  std::array<int, 3> updates{};
  std::vector<std::thread> viewers;
  for (std::size_t i = 0; i < updates.size(); ++i) {
    viewers.emplace_back([this, i, &updates] {
      Update last;
      const std::int64_t end = posix_monotonic_ns() + 2'000'000'000;
      while (posix_monotonic_ns() < end) {
        if (parse_update(body(get(server_.port(), ask(last, std::to_string(i)))), last)) ++updates[i];
      }
    });
  }
  for (std::thread& viewer : viewers) viewer.join();
  for (int count : updates) EXPECT_GE(count, 20);
  EXPECT_EQ(server_.viewers(), 3);
  EXPECT_LT(server_.encodings(), server_.replies() / 2);
}

TEST_F(LiveView, NobodyLooksNothingIsEncoded) {
  run_odometry();
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  EXPECT_EQ(server_.encodings(), 0u);
  EXPECT_EQ(server_.viewers(), 0);
}

TEST_F(LiveView, ViewersThatNeverReadOrVanishCostNothing) {
  run_odometry();
  std::vector<int> bad;
  for (int i = 0; i < 12; ++i) {
    const int fd = connect_to(server_.port());
    const int small = 1024;
    ::setsockopt(fd, SOL_SOCKET, SO_RCVBUF, &small, sizeof small);
    for (int n = 0; n < 20; ++n)
      send_text(fd, "GET /update?after=0&image=0 HTTP/1.1\r\nHost: localhost\r\n\r\n");
    if (i % 2 == 0) {
      const linger at_once{1, 0};  // vanishes with a reset
      ::setsockopt(fd, SOL_SOCKET, SO_LINGER, &at_once, sizeof at_once);
      ::close(fd);
    } else {
      bad.push_back(fd);  // stays, and reads nothing
    }
  }
  Update last;
  int updates = 0;
  const std::int64_t end = posix_monotonic_ns() + 1'500'000'000;
  while (posix_monotonic_ns() < end) {
    if (parse_update(body(get(server_.port(), ask(last, "good"))), last)) ++updates;
  }
  EXPECT_GE(updates, 15);
  EXPECT_LT(longest_ns_, 100'000'000) << "publish() waited for a viewer";
  for (int fd : bad) ::close(fd);
}

TEST_F(LiveView, AStrangersPageCannotLookThroughTheBrowser) {
  EXPECT_NE(get(server_.port(), "/update", "evil.example:8080").find("403"), std::string::npos);
  EXPECT_NE(get(server_.port(), "/", "127.0.0.1:8080").find("200 OK"), std::string::npos);
  EXPECT_NE(get(server_.port(), "/", "[::1]:8080").find("200 OK"), std::string::npos);
}

TEST_F(LiveView, NonsenseIsAnsweredAndForgotten) {
  run_odometry();
  for (const char* path :
       {"/update?after=-1&image=x&path=99999999999999999999&epoch=", "/nothing", "/update?viewer="}) {
    EXPECT_NE(get(server_.port(), path).find("HTTP/1.1"), std::string::npos) << path;
  }
  const int fd = connect_to(server_.port());
  send_text(fd, std::string(3000, '\xff') + "\r\n\r\n");
  ::close(fd);
  EXPECT_NE(get(server_.port(), "/").find("200 OK"), std::string::npos);
}

TEST_F(LiveView, ThePortIsNotShared) {
  ViewServer other;
  const Status status = other.start("127.0.0.1", server_.port());
  EXPECT_EQ(status.code(), StatusCode::kBusy) << status.message();
}

TEST_F(LiveView, StatusAloneReachesAViewerWhileTheCameraIsSilent) {
  ViewStatus status;
  status.camera = "camera unplugged";
  std::thread later([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    server_.publish_status(status);
  });
  Update update;
  EXPECT_TRUE(parse_update(body(get(server_.port(), "/update?after=0&viewer=a")), update));
  later.join();
  EXPECT_EQ(update.state["camera"], "camera unplugged");
  EXPECT_TRUE(update.colour.empty());
}

TEST(LiveViewPath, IsThinnedNotCut) {
  ViewPath path;
  for (int i = 0; i < 50'000; ++i) path.add(Vector3(0.01 * i, 0, 0));
  EXPECT_LE(path.points().size(), ViewPath::kCapacity);
  EXPECT_GT(path.points().size(), ViewPath::kCapacity / 4);
  EXPECT_GT(path.epoch(), 0u);
  EXPECT_EQ(path.points().front().x(), 0);
  EXPECT_NEAR(path.points().back().x(), 500, 1);
  for (std::size_t i = 1; i < path.points().size(); ++i) {
    ASSERT_LT(path.points()[i - 1].x(), path.points()[i].x());
  }
}

TEST(LiveViewDepth, NearIsRedFarIsBlueNothingIsBlack) {
  ViewSnapshot snapshot;
  snapshot.depth_width = 6;
  snapshot.depth_height = 2;
  snapshot.depth = {900, 0, 5500, 0, 0, 0, 0, 0, 0, 0, 0, 0};
  std::vector<std::uint8_t> rgb;
  int width = 0, height = 0;
  paint_depth(snapshot, rgb, width, height);
  ASSERT_EQ(width * height, 3);
  EXPECT_GT(rgb[0], rgb[2]);
  EXPECT_LT(rgb[3], rgb[5]);
  EXPECT_EQ(rgb[6] + rgb[7] + rgb[8], 0);
}

}  // namespace
}  // namespace plvo
