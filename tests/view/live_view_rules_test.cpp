// SPDX-License-Identifier: Apache-2.0
// Tests whom the live view answers and which connections it closes: the names in the Host header, the form of
// a request, the rule for closing connections, and the rate limits. The rules are tested alone; names and
// requests also over real sockets.
#include <gtest/gtest.h>
#include <ifaddrs.h>

#include <algorithm>

#include "plvo/view/connection_table.hpp"
#include "plvo/view/host_names.hpp"
#include "plvo/view/rate_limit.hpp"
#include "view_client.hpp"

namespace plvo {
namespace {

using namespace plvo::test;

TEST(HostNames, LoopbackAcceptsItsExactNames) {
  const HostNames names("127.0.0.1", "127.0.0.1", 8080, {});
  for (const char* good : {"127.0.0.1:8080", "localhost:8080", "LocalHost:8080", "[::1]:8080"})
    EXPECT_TRUE(names.allows(good)) << good;
  for (const char* bad : {"",
                          "127.evil.example",
                          "127.evil.example:8080",
                          "127.0.0.1.evil.example:8080",
                          "127.0.0.2:8080",
                          "127.0.0.1",
                          "127.0.0.1:80",
                          "127.0.0.1:80800",
                          "127.0.0.1:8080:8080",
                          " 127.0.0.1:8080",
                          "127.0.0.1:8080 ",
                          "localhost.:8080",
                          "localhost.evil.example:8080",
                          "evil.example:8080",
                          "x@127.0.0.1:8080",
                          "::1:8080",
                          "[::1]",
                          "0.0.0.0:8080",
                          "2130706433:8080",
                          "127.1:8080",
                          "192.168.1.5:8080"})
    EXPECT_FALSE(names.allows(bad)) << bad;
}

TEST(HostNames, SingleAddressAcceptsItselfAndTheHostName) {
  const HostNames names("robot.lan", "192.0.2.7", 8080, {});
  std::array<char, 256> own{};
  ASSERT_EQ(::gethostname(own.data(), own.size() - 1), 0);
  EXPECT_TRUE(names.allows("192.0.2.7:8080"));
  EXPECT_TRUE(names.allows("robot.lan:8080"));
  EXPECT_TRUE(names.allows(std::string(own.data()) + ":8080"));
  for (const char* bad :
       {"localhost:8080", "192.0.2.8:8080", "192.0.2.7", "192.0.2.7:8081", "evil.example:8080"})
    EXPECT_FALSE(names.allows(bad)) << bad;
}

TEST(HostNames, AnyAddressAcceptsOnlyNamesOfTheMachine) {
  const HostNames names("0.0.0.0", "0.0.0.0", 8080, {});
  ifaddrs* first = nullptr;
  ASSERT_EQ(::getifaddrs(&first), 0);
  int own = 0;
  for (const ifaddrs* one = first; one != nullptr; one = one->ifa_next) {
    if (one->ifa_addr == nullptr || one->ifa_addr->sa_family != AF_INET) continue;
    const std::uint32_t n = ntohl(reinterpret_cast<const sockaddr_in*>(one->ifa_addr)->sin_addr.s_addr);
    const std::string text = std::to_string(n >> 24) + '.' + std::to_string(n >> 16 & 255) + '.' +
                             std::to_string(n >> 8 & 255) + '.' + std::to_string(n & 255);
    EXPECT_TRUE(names.allows(text + ":8080")) << text;
    ++own;
  }
  ::freeifaddrs(first);
  EXPECT_GE(own, 1);
  for (const char* bad :
       {"127.evil.example:8080", "evil.example:8080", "203.0.113.9:8080", "0.0.0.0:8080", ""})
    EXPECT_FALSE(names.allows(bad)) << bad;
}

TEST(HostNames, ExtraNamesWithAndWithoutAPort) {
  const HostNames names("127.0.0.1", "127.0.0.1", 8080, {"Robot.local", "tunnel:9000", "proxy.example:443"});
  for (const char* good : {"robot.local:8080", "tunnel:9000", "proxy.example", "proxy.example:443"})
    EXPECT_TRUE(names.allows(good)) << good;
  for (const char* bad : {"robot.local", "robot.local:9000", "tunnel:8080", "tunnel", "proxy.example:8080"})
    EXPECT_FALSE(names.allows(bad)) << bad;
  EXPECT_TRUE(HostNames("127.0.0.1", "127.0.0.1", 80, {}).allows("localhost"));
}

TEST(HostNames, InvalidNamesAreRefused) {
  for (const char* good : {"robot", "robot.local", "my_robot-2:80", "[::1]", "[fe80::1]:8080", "10.0.0.1:1"})
    EXPECT_TRUE(HostNames::is_valid(good)) << good;
  for (const char* bad : {"", ":80", "*", "*.local", "a b", "robot:", "robot:0", "robot:65536", "robot:8x",
                          "http://robot", "robot/", "::1", "[robot]", "[::1", "a:1:2"})
    EXPECT_FALSE(HostNames::is_valid(bad)) << bad;
}

struct Table {
  std::vector<int> hung_up;
  ConnectionTable table{[this](int descriptor) { hung_up.push_back(descriptor); }};
};

TEST(ConnectionTable, ClosesThoseWithoutRequestThenTheSilentThenTheSlowest) {
  Table t;
  const int share = static_cast<int>(ConnectionTable::kMaxPerAddress);
  for (int i = 0; i < share; ++i) t.table.opened(i, "a", i);
  t.table.asked(0, 1000);
  t.table.answered(0, 1001);
  t.table.asked(0, 1002);  // a viewer at its second reply
  t.table.asked(1, 1003);
  t.table.answered(1, 1004);  // a viewer between two requests
  for (int i = 2; i < share; ++i) {
    t.table.opened(100 + i, "a", 2000 + i);
    ASSERT_EQ(t.hung_up.back(), i) << "the oldest that never asked";
  }
  for (int i = 2; i < share; ++i) t.table.asked(100 + i, 3000 + i);  // and never fetch the reply
  t.table.opened(500, "a", 4000);
  EXPECT_EQ(t.hung_up.back(), 1) << "the silent one";
  for (int i = 2; i < share; ++i) {
    t.table.asked(498 + i, 4500 + i);
    t.table.opened(499 + i, "a", 5000 + i);
    ASSERT_EQ(t.hung_up.back(), 100 + i) << "the one that has been at its first reply for longest";
  }
  EXPECT_EQ(std::count(t.hung_up.begin(), t.hung_up.end(), 0), 0) << "the viewer was not touched";
  EXPECT_EQ(t.table.count(), ConnectionTable::kMaxPerAddress);
}

TEST(ConnectionTable, FullTableClosesAConnectionOfTheLargestAddress) {
  Table t;
  const int share = static_cast<int>(ConnectionTable::kMaxPerAddress);
  const int all = static_cast<int>(ConnectionTable::kMaxConnections);
  for (int i = 0; i < share; ++i) t.table.opened(i, "greedy", i);
  for (int i = share; i < all; ++i) t.table.opened(i, "machine " + std::to_string(i), 0);
  EXPECT_TRUE(t.hung_up.empty());
  for (int i = 0; i < 10; ++i) t.table.opened(1000 + i, "newcomer", 100 + i);
  EXPECT_EQ(t.hung_up, (std::vector<int>{0, 1, 2, 3, 4, 5, 6, 7, 8, 9}));
  EXPECT_EQ(t.table.count(), ConnectionTable::kMaxConnections);
}

TEST(ConnectionTable, OverdueConnectionIsClosedOnce) {
  Table t;
  t.table.opened(1, "a", 0);
  t.table.opened(2, "a", 0);
  t.table.asked(2, 0);
  t.table.hang_up_overdue(ConnectionTable::kRequest_ns);
  EXPECT_TRUE(t.hung_up.empty());
  t.table.hang_up_overdue(ConnectionTable::kRequest_ns + 1);
  t.table.hang_up_overdue(ConnectionTable::kRequest_ns + 2);
  EXPECT_EQ(t.hung_up, std::vector<int>{1});
  EXPECT_TRUE(t.table.is_over(1));
  EXPECT_FALSE(t.table.is_over(2));
  t.table.hang_up_overdue(ConnectionTable::kReply_ns + 1);
  EXPECT_EQ(t.hung_up, (std::vector<int>{1, 2}));
  t.table.closed(1);
  t.table.opened(1, "b", ConnectionTable::kReply_ns);  // the descriptor is used again
  EXPECT_EQ(t.table.count(), 1u);
  EXPECT_FALSE(t.table.is_over(1));
}

constexpr std::int64_t kSecond = 1'000'000'000;

TEST(RateLimit, AllowsABurstThenTheRate) {
  RateLimit limit({kSecond / 10, 2 * kSecond}, {1, 1000 * kSecond});
  int allowed = 0;
  const auto ask = [&](std::int64_t now_ns) {
    if (!limit.allows("a", now_ns)) return false;
    limit.spend("a", 1, now_ns);
    ++allowed;
    return true;
  };
  while (ask(0)) continue;
  EXPECT_EQ(allowed, 20);
  for (std::int64_t ms = 1; ms <= 10'000; ++ms) ask(ms * 1'000'000);
  EXPECT_EQ(allowed, 20 + 100);
  EXPECT_TRUE(limit.allows("b", 10 * kSecond)) << "another address has a bucket of its own";
  allowed = 0;
  while (ask(10'000 * kSecond)) continue;
  EXPECT_EQ(allowed, 20) << "a bucket does not grow beyond its depth";
}

TEST(RateLimit, ManyAddressesShareOneBucketAndAreForgotten) {
  RateLimit limit({kSecond / 10, kSecond}, {kSecond / 40, kSecond});
  int allowed = 0;
  for (int i = 0; i < 1000; ++i) {
    const std::string address = std::to_string(i);
    if (!limit.allows(address, 0)) continue;
    limit.spend(address, 1, 0);
    ++allowed;
  }
  EXPECT_EQ(allowed, 40);
  EXPECT_EQ(limit.known_addresses(), 40u);
  limit.spend("last", 1, kSecond);
  EXPECT_EQ(limit.known_addresses(), 1u);
}

TEST(RateLimit, OverdraftIsRepaid) {
  RateLimit limit({1000, kSecond}, {1, 1000 * kSecond});
  ASSERT_TRUE(limit.allows("a", 0));
  limit.spend("a", 5'000'000, 0);  // five seconds' worth
  EXPECT_FALSE(limit.allows("a", 4 * kSecond));
  EXPECT_TRUE(limit.allows("a", 4 * kSecond + 1));
}

class ViewNames : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!ViewServer::available()) GTEST_SKIP() << "built without libmicrohttpd";
  }
  int asking_as(const std::string& header) const {
    return status_of(request(server_.port(), "GET /update?after=9", header));
  }
  ViewServer server_;
};

TEST_F(ViewNames, ForeignPageCannotReadThroughTheBrowser) {
  ASSERT_TRUE(server_.start("127.0.0.1", 0).ok());
  const int port = server_.port();
  EXPECT_EQ(asking_as(host_header(port)), 200);
  EXPECT_EQ(asking_as(host_header(port, "127.0.0.1")), 200);
  for (const char* name :
       {"127.evil.example", "evil.example", "localhost.evil.example", "127.0.0.1.nip.example"})
    EXPECT_EQ(asking_as(host_header(port, name)), 403) << name;
  EXPECT_EQ(asking_as(host_header(port + 1)), 403);
  EXPECT_EQ(asking_as("Host: localhost\r\n"), 403);
  EXPECT_EQ(asking_as(host_header(port) + "Host: evil.example\r\n"), 403) << "which one is meant?";
  EXPECT_GE(asking_as(""), 400);
  EXPECT_NE(get(port, "/").find("frame-ancestors 'none'"), std::string::npos);
}

// Requests that libmicrohttpd and a proxy in front of it might read differently.
TEST_F(ViewNames, AmbiguousRequestsAreRejected) {
  ASSERT_TRUE(server_.start("127.0.0.1", 0).ok());
  const int port = server_.port();
  const std::string host = host_header(port), name = "localhost:" + std::to_string(port);
  const std::string end = "Connection: close\r\n\r\n", line = "GET /update?after=9 HTTP/1.1\r\n";
  using namespace std::string_literals;
  for (const std::string& good :
       {line + host + end, line + "Host:" + name + "\r\n" + end, line + "host: \t " + name + "\r\n" + end,
        line + host + "X-Empty:\r\nX-Long: a b  c\r\n" + end, line + host + "Content-Length: 0\r\n" + end,
        "GET /update?viewer=%00+x%2 HTTP/1.1\r\n" + host + end, "GET /update? HTTP/1.0\r\n" + host + end})
    EXPECT_EQ(status_of(reply_to(port, good)), 200) << good;
  for (const std::string& bad :
       {line + "Host: " + name + "\0.evil\r\n"s + end, line + "Host: " + name + "\0\r\n"s + end,
        line + "Host:" + name + "\0\r\n"s + end, line + host + "X: a\0b\r\n"s + end,
        line + host + "X\0: a\r\n"s + end, line + host + "X: \x01\r\n" + end,
        "GET /update\0.html HTTP/1.1\r\n"s + host + end, "GET\0X /update HTTP/1.1\r\n"s + host + end,
        "GET /update HTTP/1.1\0\r\n"s + host + end, "GET  /update HTTP/1.1\r\n" + host + end,
        line + host + "Host : evil.example\r\n" + end, line + host + "X: a\n" + end,
        line + host + "X: a\rHost: evil.example\r\n" + end, line + host + " folded\r\n" + end,
        line + host + "Content-Length: 0\r\nContent-Length: 0\r\n" + end,
        line + host + "Content-Length: 0\r\nContent-Length: 5\r\n" + end,
        line + host + "Content-Length: 0\r\nTransfer-Encoding: identity\r\n" + end,
        line + host + "Content-Length: +0\r\n" + end})
    EXPECT_EQ(status_of(reply_to(port, bad)), 400) << testing::PrintToString(bad);
}

TEST_F(ViewNames, EscapedPathsAreNotFound) {
  ASSERT_TRUE(server_.start("127.0.0.1", 0).ok());
  for (const char* path : {"/update%00.html", "/%75pdate", "/%00", "/update/", "//", "/update%3Fafter=9"})
    EXPECT_EQ(status_of(get(server_.port(), path)), 404) << path;
}

TEST_F(ViewNames, NamesAreCheckedOnEveryAddress) {
  ASSERT_TRUE(server_.start("0.0.0.0", 0, {"robot.local"}).ok());
  const int port = server_.port();
  EXPECT_EQ(asking_as(host_header(port)), 200);
  EXPECT_EQ(asking_as(host_header(port, "robot.local")), 200);
  for (const char* name : {"127.evil.example", "evil.example", "203.0.113.9"})
    EXPECT_EQ(asking_as(host_header(port, name)), 403) << name;
}

}  // namespace
}  // namespace plvo
