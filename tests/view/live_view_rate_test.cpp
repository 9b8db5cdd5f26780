// SPDX-License-Identifier: Apache-2.0
// Measures the updates per second that viewers get, alone and among slow, silent and stuck clients. It needs
// an idle machine and is not part of the suite: ctest -C bench -L bench.
#include <gtest/gtest.h>

#include <chrono>
#include <memory>

#include "view_client.hpp"

namespace plvo {
namespace {

using namespace plvo::test;

TEST(LiveViewRate, TenUpdatesASecondForEachOfThreeViewers) {
  ASSERT_TRUE(ViewServer::available());
  ViewServer server;
  ASSERT_TRUE(server.start("127.0.0.1", 0).ok());
  Scene scene(640, 480);
  std::atomic<bool> stop{false};
  std::thread camera([&] {
    while (!stop) {
      scene.publish_to(server);
      std::this_thread::sleep_for(std::chrono::milliseconds(33));
    }
  });
  std::vector<std::unique_ptr<Viewer>> viewers;
  for (int i = 0; i < 3; ++i) viewers.push_back(std::make_unique<Viewer>(server.port(), std::to_string(i)));
  for (const auto& viewer : viewers) viewer->wait_for(1);
  std::vector<int> others;
  for (const int strangers : {0, 600}) {
    for (int i = 0; i < strangers; ++i) {
      others.push_back(connect_to(server.port()));
      if (i % 2 == 0) send_text(others.back(), "GET /", MSG_DONTWAIT);
      if (i % 10 == 0)
        send_text(others.back(), "update?after=0 HTTP/1.1\r\n" + host_header(server.port()) + "\r\n");
    }
    std::array<std::size_t, 3> before{};
    for (std::size_t i = 0; i < viewers.size(); ++i) before[i] = viewers[i]->images().size();
    constexpr int kSeconds = 3;
    std::this_thread::sleep_for(std::chrono::seconds(kSeconds));
    for (std::size_t i = 0; i < viewers.size(); ++i) {
      const double rate = static_cast<double>(viewers[i]->images().size() - before[i]) / kSeconds;
      std::printf("%d strangers, viewer %zu: %.1f updates/s\n", strangers, i, rate);
      EXPECT_GE(rate, 10);
    }
  }
  for (const auto& viewer : viewers) viewer->stop();
  stop = true;
  camera.join();
  for (int fd : others) ::close(fd);
}

}  // namespace
}  // namespace plvo
