// SPDX-License-Identifier: Apache-2.0
// Tests the server of the live view with real sockets: what one or several viewers get, and the cost of each
// image. Hostile clients: live_view_soak_test.cpp; updates per second: live_view_rate_test.cpp.
#include <gtest/gtest.h>

#include <memory>
#include <numeric>

#include "view_client.hpp"

namespace plvo {
namespace {

using namespace plvo::test;

class LiveView : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!ViewServer::available()) GTEST_SKIP() << "built without libmicrohttpd";
    const Status status = server_.start("127.0.0.1", 0);
    ASSERT_TRUE(status.ok()) << status.message();
  }
  Scene scene_;
  ViewServer server_;
};

TEST_F(LiveView, ThePageIsOneFileThatMayNotLoadOthers) {
  const std::string reply = get(server_.port(), "/");
  EXPECT_EQ(status_of(reply), 200);
  EXPECT_NE(reply.find("default-src 'none'"), std::string::npos);
  EXPECT_NE(reply.find("<canvas id=\"space\""), std::string::npos);
  EXPECT_EQ(reply.find("http://"), std::string::npos);
  EXPECT_EQ(reply.find("https://"), std::string::npos);
}

TEST_F(LiveView, AnUpdateHoldsStateFeaturesAndPictures) {
  Update update;
  while (update.colour.empty()) {
    const std::string reply = get(server_.port(), ask(update, "one"));
    ASSERT_EQ(status_of(reply), 200) << reply;
    parse_update(body(reply), update);
    scene_.publish_to(server_);
  }
  EXPECT_EQ(update.colour.substr(0, 3), "\xff\xd8\xff");  // JPEG
  EXPECT_EQ(update.depth.substr(0, 3), "\xff\xd8\xff");
  EXPECT_EQ(update.state["state"], "tracking");
  EXPECT_EQ(update.state["size"], nlohmann::json({scene_.width, scene_.height}));
  EXPECT_EQ(update.state["covariance"].size(), 36u);
  ASSERT_EQ(update.state["points"].size(), 5u * 5);
  EXPECT_EQ(update.state["points"][15],
            12.0);  // the first track: current position, reference position, inlier
  EXPECT_EQ(update.state["points"][17], 10.0);
  EXPECT_EQ(update.state["points"][19], 3);
  EXPECT_EQ(update.state["points"][24], 2);
  ASSERT_EQ(update.state["segments"].size(), 3u * 5);
  EXPECT_EQ(update.state["segments"][4], 0);   // detected
  EXPECT_EQ(update.state["segments"][9], 1);   // with depth
  EXPECT_EQ(update.state["segments"][14], 3);  // inlier
  EXPECT_GE(update.state["path"].size(), 3u);
}

TEST_F(LiveView, EachOfThreeViewersGetsEveryImageFromOneEncoding) {
  constexpr std::uint64_t kImages = 12;
  std::vector<std::unique_ptr<Viewer>> viewers;
  for (int i = 0; i < 3; ++i) viewers.push_back(std::make_unique<Viewer>(server_.port(), std::to_string(i)));
  while (server_.viewers() < 3) std::this_thread::yield();
  for (std::uint64_t n = 1; n <= kImages; ++n) {
    ASSERT_EQ(publish_one(scene_, server_), n);
    for (const auto& viewer : viewers) viewer->wait_for(n);
  }
  std::vector<std::uint64_t> all(kImages);
  std::iota(all.begin(), all.end(), 1);
  for (const auto& viewer : viewers) {
    viewer->stop();
    EXPECT_EQ(viewer->images(), all);
  }
  EXPECT_EQ(server_.encodings(), kImages);
  EXPECT_GE(server_.replies(), 3 * kImages);
}

TEST_F(LiveView, WithoutViewersNothingIsCopiedOrEncoded) {
  for (int i = 0; i < 100; ++i) scene_.publish_to(server_);
  EXPECT_EQ(server_.images(), 0u);
  EXPECT_EQ(server_.encodings(), 0u);
  EXPECT_EQ(server_.viewers(), 0);
}

TEST_F(LiveView, InvalidRequestsDoNoHarm) {
  scene_.publish_to(server_);
  const int port = server_.port();
  EXPECT_EQ(status_of(get(port, "/nothing")), 404);
  EXPECT_EQ(status_of(get(port, "/update?viewer=")), 200);
  EXPECT_EQ(status_of(get(port, "/update?after=-1&image=x&path=99999999999999999999&epoch=")), 200);
  EXPECT_EQ(status_of(request(port, "DELETE /", host_header(port))), 405);
  EXPECT_EQ(status_of(request(port, "POST /update", host_header(port) + "Content-Length: 9999999999\r\n")),
            405);
  EXPECT_EQ(status_of(request(port, "GET /", host_header(port) + "Content-Length: 9999999999\r\n")), 400);
  EXPECT_EQ(status_of(request(port, "GET /", host_header(port) + "Transfer-Encoding: chunked\r\n")), 400);
  const int fd = connect_to(port);
  send_text(fd, std::string(3000, '\xff') + "\r\n\r\n");
  ::close(fd);
  EXPECT_EQ(status_of(get(port, "/")), 200);
}

TEST_F(LiveView, ThePortIsNotShared) {
  ViewServer other;
  const Status status = other.start("127.0.0.1", server_.port());
  EXPECT_EQ(status.code(), StatusCode::kBusy) << status.message();
}

TEST_F(LiveView, StatusAloneReachesAViewerWhileTheCameraIsSilent) {
  ViewStatus status;
  status.camera = "camera unplugged";
  Update update;
  std::thread viewer([&] {
    while (update.state.is_null()) parse_update(body(get(server_.port(), ask(update, "a"))), update);
  });
  while (server_.viewers() == 0) std::this_thread::yield();  // it waits for news, or is about to
  server_.publish_status(status);
  viewer.join();
  EXPECT_EQ(update.state["camera"], "camera unplugged");
  EXPECT_TRUE(update.colour.empty());
}

TEST_F(LiveView, AMapIsToldWhereThereIsOne) {
  ViewStatus status;
  Update update;
  const auto ask_once = [&] {
    update = Update();
    server_.publish_status(status);
    parse_update(body(get(server_.port(), ask(update, "a"))), update);
  };
  ask_once();
  EXPECT_FALSE(update.state.contains("map"));
  status.map = {true, 12};
  server_.publish_map_way(std::vector<Vector3>{{1, 2, 3}, {4, 5, 6.00001}});
  ask_once();
  EXPECT_EQ(update.state["map"]["located"], true);
  EXPECT_EQ(update.state["map"]["loops"], 12);
  EXPECT_EQ(update.state["map"]["way"], nlohmann::json({1.0, 2.0, 3.0, 4.0, 5.0, 6.0}));
}

TEST_F(LiveView, StopEndsWaitingRequests) {
  std::string reply;
  std::thread viewer([&] { reply = get(server_.port(), ask({}, "a")); });
  while (server_.viewers() == 0) std::this_thread::yield();
  server_.stop();
  viewer.join();
  EXPECT_EQ(server_.connections(), 0);
}

TEST(LiveViewPath, IsThinnedNotTruncated) {
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
