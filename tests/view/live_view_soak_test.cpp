// SPDX-License-Identifier: Apache-2.0
// Two viewers among slow, silent, huge, many, greedy and vanishing clients: each viewer still gets every
// image, the memory stays below a limit, and the numbers of connections and replies stay within the
// documented limits. The publisher waits for the viewers, so that a busy machine only makes the test slower.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <numeric>
#include <sstream>

#include "plvo/host/posix_clock.hpp"
#include "plvo/view/connection_table.hpp"
#include "plvo/view/reply_queue.hpp"
#include "view_client.hpp"

namespace plvo {
namespace {

using namespace plvo::test;

// The server's buffers, the replies that are not fetched, and the buffers of this test.
constexpr long kCeiling_kB = 24 * 1024;
constexpr std::size_t kLine = 300'000'000, kHeaders = 65'000'000;  // bytes
constexpr int kRounds = 24;
constexpr int kSilent = 600, kSlow = 40, kStuck = 24, kVanishing = 12;

long resident_kB() {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;) {
    long kilobytes = 0;
    if (word == "VmRSS:" && status >> kilobytes) return kilobytes;
  }
  return 0;
}
bool memory_can_be_judged() {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  return false;  // their own bookkeeping is many times larger
#else
  return resident_kB() > 0;
#endif
}

bool is_open(int fd) {
  pollfd one{fd, POLLRDHUP, 0};
  return ::poll(&one, 1, 0) == 0;
}
void vanish(int fd) {
  const linger at_once{1, 0};  // close with a reset
  ::setsockopt(fd, SOL_SOCKET, SO_LINGER, &at_once, sizeof at_once);
  ::close(fd);
}
int open_stuck(int port) {
  const int fd = connect_to(port);
  const int small = 1024;
  ::setsockopt(fd, SOL_SOCKET, SO_RCVBUF, &small, sizeof small);
  for (int n = 0; n < 20; ++n) {
    send_text(fd, "GET /update?after=0&image=0 HTTP/1.1\r\n" + host_header(port) + "\r\n", MSG_DONTWAIT);
  }
  return fd;
}
// Sends `unit` until `total` bytes are sent or the server closes the connection; returns the number of bytes
// sent.
std::size_t send_endlessly(int fd, const std::string& unit, std::size_t total) {
  std::size_t sent = 0;
  while (sent < total) {
    const ssize_t some = ::send(fd, unit.data(), unit.size(), MSG_NOSIGNAL);
    if (some <= 0) break;
    sent += static_cast<std::size_t>(some);
  }
  return sent;
}

class LiveViewSoak : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!ViewServer::available()) GTEST_SKIP() << "built without libmicrohttpd";
    ASSERT_TRUE(server_.start("127.0.0.1", 0).ok());
    for (int i = 0; i < 2; ++i)
      viewers_.push_back(std::make_unique<Viewer>(server_.port(), std::to_string(i)));
    for (int i = 0; i < 3; ++i) serve_one();
    before_kB_ = highest_kB_ = resident_kB();
  }
  // Publishes one image and waits until every viewer has it.
  void serve_one() {
    const std::uint64_t image = publish_one(scene_, server_);
    for (const auto& viewer : viewers_) viewer->wait_for(image);
    highest_kB_ = std::max(highest_kB_, resident_kB());
    most_connections_ = std::max(most_connections_, server_.connections());
  }
  void TearDown() override {
    if (viewers_.empty()) return;
    const std::uint64_t last = server_.images();
    for (const auto& viewer : viewers_) {
      viewer->stop();
      std::vector<std::uint64_t> all(last - viewer->images().front() + 1);
      std::iota(all.begin(), all.end(), viewer->images().front());
      EXPECT_EQ(viewer->images(), all) << "a viewer missed some";
    }
    // The library counts a closed connection until it handles it again.
    EXPECT_LE(most_connections_, static_cast<int>(2 * ConnectionTable::kMaxPerAddress));
    if (memory_can_be_judged()) {
      EXPECT_LE(highest_kB_ - before_kB_, kCeiling_kB);
    }
    std::printf("memory grew by %ld kB; at most %d connections; the viewers took %d and %d\n",
                highest_kB_ - before_kB_, most_connections_, viewers_[0]->connections(),
                viewers_[1]->connections());
  }

  Scene scene_{160, 120};
  ViewServer server_;
  std::vector<std::unique_ptr<Viewer>> viewers_;
  long before_kB_ = 0, highest_kB_ = 0;
  int most_connections_ = 0;
};

TEST_F(LiveViewSoak, SilentSlowStuckAndVanishingClientsKeepNoViewerOut) {
  const int port = server_.port();
  std::vector<int> silent, slow, stuck;
  const std::string letters = "GET /" + std::string(200, 'a');
  for (int round = 0; round < kRounds; ++round) {
    for (int i = 0; i < kSilent / kRounds; ++i) silent.push_back(connect_to(port));
    // Each slow client adds a byte, and reconnects if it was closed.
    slow.resize(kSlow, -1);
    for (int& fd : slow) {
      if (fd >= 0 && send_text(fd, letters.substr(static_cast<std::size_t>(round), 1), MSG_DONTWAIT))
        continue;
      if (fd >= 0) ::close(fd);
      fd = connect_to(port);
    }
    stuck.resize(kStuck, -1);
    for (int& fd : stuck) {
      if (fd >= 0 && is_open(fd)) continue;
      if (fd >= 0) ::close(fd);
      fd = open_stuck(port);
    }
    for (int i = 0; i < kVanishing; ++i) vanish(open_stuck(port));
    serve_one();
    // A new viewer from the same address is accepted as soon as the rate of connections allows.
    while (status_of(get(port, "/")) != 200) std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  const auto open = std::count_if(silent.begin(), silent.end(), is_open);
  EXPECT_LE(open, static_cast<std::ptrdiff_t>(2 * ConnectionTable::kMaxPerAddress)) << "of " << silent.size();
  for (const auto& list : {silent, slow, stuck})
    for (int fd : list) ::close(fd);
}

TEST_F(LiveViewSoak, SlowRequestsAndSilentConnectionsAreClosed) {
  const int silent = connect_to(server_.port());
  const int slow = connect_to(server_.port());
  for (bool both = true; both; both = is_open(silent) || is_open(slow)) {
    send_text(slow, "G", MSG_DONTWAIT);  // an occasional byte does not keep the connection open
    serve_one();
  }
  ::close(silent);
  ::close(slow);
}

// The allowed number depends on the elapsed time, which is longer on a busy machine.
TEST_F(LiveViewSoak, ReconnectingClientIsAnsweredTenTimesASecond) {
  constexpr int kAttempts = 1320, kAtOnce = 32, kPerSecond = 10;
  int answered = 0;
  const std::int64_t began = posix_monotonic_ns();
  for (int i = 0; i < kAttempts; ++i) {
    answered += status_of(get(server_.port(), "/update?after=0")) == 200 ? 1 : 0;
    if (i % 100 == 0) serve_one();
  }
  const double seconds = static_cast<double>(posix_monotonic_ns() - began) * 1e-9;
  std::printf("%d of %d connections in %.1f s were answered\n", answered, kAttempts, seconds);
  EXPECT_GE(answered, 1);
  EXPECT_LE(answered, kAtOnce + 1 + kPerSecond * seconds);
}

TEST_F(LiveViewSoak, GreedyClientGetsEightMegabytesASecond) {
  constexpr int kRequests = 600;
  constexpr double kAtOnce = 8e6, kPerSecond = 8e6;
  const int fd = connect_to(server_.port());
  const std::int64_t began = posix_monotonic_ns();
  std::thread asks([fd, port = server_.port()] {
    for (int i = 0; i < kRequests; ++i)
      send_text(fd, "GET / HTTP/1.1\r\n" + host_header(port) +
                        (i + 1 < kRequests ? "" : "Connection: close\r\n") + "\r\n");
  });
  const std::string replies = read_to_end(fd);
  asks.join();
  const double seconds = static_cast<double>(posix_monotonic_ns() - began) * 1e-9;
  ::close(fd);
  std::printf("%zu bytes in %.1f s\n", replies.size(), seconds);
  std::size_t pages = 0;
  for (std::size_t at = 0; (at = replies.find("HTTP/1.1 200", at)) != std::string::npos; ++at) ++pages;
  EXPECT_EQ(pages, kRequests);
  const double cost = static_cast<double>(replies.size() + kRequests * ReplyQueue::kReplyBytes);
  EXPECT_LE(cost, (kAtOnce + kPerSecond * seconds) * 1.05);
}

TEST_F(LiveViewSoak, ServerThreadsHaveTheLowestPriority) {
  const auto nice = [](const std::filesystem::path& task) {
    std::ifstream file(task / "stat");
    std::string text(std::istreambuf_iterator<char>(file), {});
    std::istringstream fields(text.substr(text.rfind(')') + 2));  // from the third field on
    std::string field;
    for (int i = 3; i <= 19; ++i) fields >> field;
    return field;
  };
  std::size_t lowest = 0;
  for (const auto& task : std::filesystem::directory_iterator("/proc/self/task"))
    lowest += nice(task.path()) == "19" ? 1 : 0;
  EXPECT_GE(lowest, 2u) << "one moves the bytes, one composes";
}

TEST_F(LiveViewSoak, EndlessRequestLinesAndHeadersAreCutOff) {
  const int line = connect_to(server_.port());
  std::thread sends_line([line] {
    send_text(line, "GET /");
    EXPECT_LT(send_endlessly(line, std::string(65536, 'a'), kLine), kLine) << "the server read all of it";
  });
  const int headers = connect_to(server_.port());
  std::thread sends_headers([headers, port = server_.port()] {
    send_text(headers, "GET / HTTP/1.1\r\n" + host_header(port));
    std::string unit;
    for (int i = 0; i < 1000; ++i)
      unit += "X-Padding-" + std::to_string(i) + ": " + std::string(48, 'x') + "\r\n";
    EXPECT_LT(send_endlessly(headers, unit, kHeaders), kHeaders) << "the server read all of it";
  });
  for (int round = 0; round < 10; ++round) serve_one();
  sends_line.join();
  sends_headers.join();
  serve_one();
  ::close(line);
  ::close(headers);
}

}  // namespace
}  // namespace plvo
