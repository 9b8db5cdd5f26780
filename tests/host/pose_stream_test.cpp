// SPDX-License-Identifier: Apache-2.0
// Poses as JSON lines: the text itself, several readers, and readers that do not read, vanish, or come late.
#include "plvo/host/pose_stream.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>

#include "plvo/host/pose_json.hpp"
#include "temporary_folder.hpp"

namespace plvo {
namespace {

TrackResult sample(std::int64_t stamp_ns) {
  TrackResult result;
  result.state = TrackState::kTracking;
  result.stamp_ns = stamp_ns;
  result.T_world_camera.t = Vector3(1.5, -2, 0.25);
  result.T_world_camera.R = rotation_exp(Vector3(0, 0, 1));
  result.pose_covariance = Matrix6::Identity() * 1e-6;
  result.points.inliers = 42;
  result.lines.matched = 7;
  return result;
}

int connect_tcp(int port) {
  const int fd = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_port = htons(static_cast<std::uint16_t>(port));
  to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  EXPECT_EQ(::connect(fd, reinterpret_cast<const sockaddr*>(&to), sizeof to), 0);
  return fd;
}
int connect_unix(const std::string& path) {
  const int fd = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_un to{};
  to.sun_family = AF_UNIX;
  std::memcpy(to.sun_path, path.c_str(), path.size() + 1);
  EXPECT_EQ(::connect(fd, reinterpret_cast<const sockaddr*>(&to), sizeof to), 0);
  return fd;
}
// Everything up to the end of the stream, or until nothing came for 200 ms.
std::string read_all(int fd) {
  std::string text;
  std::array<char, 4096> bytes{};
  for (;;) {
    pollfd one{fd, POLLIN, 0};
    if (::poll(&one, 1, 200) != 1) break;
    const ssize_t got = ::read(fd, bytes.data(), bytes.size());
    if (got <= 0) break;
    text.append(bytes.data(), static_cast<std::size_t>(got));
  }
  return text;
}
std::vector<nlohmann::json> lines_of(const std::string& text) {
  std::vector<nlohmann::json> lines;
  std::size_t start = 0;
  for (std::size_t end = 0; (end = text.find('\n', start)) != std::string::npos; start = end + 1) {
    lines.push_back(nlohmann::json::parse(text.substr(start, end - start)));
  }
  EXPECT_EQ(start, text.size()) << "the last line is cut";
  return lines;
}

TEST(PoseJson, SaysEverything) {
  TrackResult result = sample(1'600'000'001'033'333'000);
  result.state = TrackState::kLost;
  result.status =
      Status(StatusCode::kTooFewFeatures, "only \"3\" points \\ 0 lines\nlamp off\x01 caf\xc3\xa9");
  const nlohmann::json json = nlohmann::json::parse(pose_json(result));
  EXPECT_EQ(json["stamp_ns"].get<std::int64_t>(), 1'600'000'001'033'333'000);
  EXPECT_EQ(json["state"], to_string(TrackState::kLost));
  EXPECT_EQ(json["status"], "too_few_features");
  EXPECT_EQ(json["message"], "only \"3\" points \\ 0 lines lamp off? caf??");
  EXPECT_NEAR(json["position"][1].get<double>(), -2, 1e-9);
  EXPECT_NEAR(json["orientation_xyzw"][2].get<double>(), std::sin(0.5), 1e-8);
  ASSERT_EQ(json["covariance"].size(), 36u);
  EXPECT_NEAR(json["covariance"][7].get<double>(), 1e-6, 1e-15);
  EXPECT_EQ(json["points"]["inliers"], 42);
  EXPECT_EQ(json["lines"]["matched"], 7);
}

TEST(PoseJson, NumbersThatJsonDoesNotKnowBecomeNull) {
  TrackResult result = sample(1);
  result.T_world_camera.t.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(nlohmann::json::parse(pose_json(result))["position"][0].is_null());
}

// How often this thread gave its processor away to wait for something; being interrupted by others does not
// count.
long voluntary_waits() {
  rusage usage{};
  ::getrusage(RUSAGE_THREAD, &usage);
  return usage.ru_nvcsw;
}

TEST(PoseStream, SeveralTcpReadersEachGetEveryLineSinceTheyCame) {
  PoseStream stream;
  ASSERT_TRUE(stream.open("0").ok());
  ASSERT_TRUE(stream.write(sample(1)).ok());  // nobody listens: nothing happens
  const int first = connect_tcp(stream.port());
  ASSERT_TRUE(stream.write(sample(2)).ok());
  const int second = connect_tcp(stream.port());
  ASSERT_TRUE(stream.write(sample(3)).ok());
  EXPECT_EQ(stream.readers(), 2u);
  const auto lines = lines_of(read_all(first));
  ASSERT_EQ(lines.size(), 2u);
  EXPECT_EQ(lines[0]["stamp_ns"], 2);
  EXPECT_EQ(lines[1]["stamp_ns"], 3);
  EXPECT_EQ(lines_of(read_all(second)).size(), 1u);
  ::close(first);
  for (int n = 4; n < 8; ++n) ASSERT_TRUE(stream.write(sample(n)).ok());
  EXPECT_EQ(stream.readers(), 1u);
  EXPECT_EQ(lines_of(read_all(second)).size(), 4u);
  ::close(second);
}

TEST(PoseStream, ReaderThatNeverReadsCostsNothingAndLosesWholeLines) {
  test::TemporaryFolder folder;
  const std::string path = (folder / "poses").string();
  PoseStream stream;
  ASSERT_TRUE(stream.open("unix:" + path).ok());
  const int stuck = connect_unix(path);
  const int good = connect_unix(path);
  std::size_t got = 0;
  long waits = 0;
  for (int n = 0; n < 500; ++n) {
    const long before = voluntary_waits();
    ASSERT_TRUE(stream.write(sample(n)).ok());
    waits += voluntary_waits() - before;
    if (n % 100 == 99) got += lines_of(read_all(good)).size();
  }
  EXPECT_GT(stream.dropped_lines(), 0u);
  EXPECT_EQ(got, 500u);  // the other reader missed nothing
  EXPECT_EQ(waits, 0) << "a write waited for a reader";
  stream.close();
  lines_of(read_all(stuck));  // no line is cut, what came is whole
  ::close(stuck);
  ::close(good);
}

TEST(PoseStream, UnixSocketLeftOverFromACrashIsReplacedAndALiveOneIsNot) {
  test::TemporaryFolder folder;
  const std::string path = (folder / "poses").string();
  const int crashed = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_un name{};
  name.sun_family = AF_UNIX;
  std::memcpy(name.sun_path, path.c_str(), path.size() + 1);
  ASSERT_EQ(::bind(crashed, reinterpret_cast<const sockaddr*>(&name), sizeof name), 0);
  ::close(crashed);
  PoseStream stream;
  EXPECT_TRUE(stream.open("unix:" + path).ok());
  PoseStream other;
  EXPECT_EQ(other.open("unix:" + path).code(), StatusCode::kBusy);
  stream.close();
  EXPECT_FALSE(std::filesystem::exists(path));
  test::write_file(path, "a file of the user's");
  EXPECT_EQ(other.open("unix:" + path).code(), StatusCode::kBusy);
  EXPECT_EQ(test::read_file(path), "a file of the user's");
}

TEST(PoseStream, PortInUseAndNonsense) {
  PoseStream stream;
  ASSERT_TRUE(stream.open("127.0.0.1:0").ok());
  PoseStream other;
  const Status busy = other.open(std::to_string(stream.port()));
  EXPECT_EQ(busy.code(), StatusCode::kBusy) << busy.message();
  for (const char* address : {"", "seven", "70000", "-1", "::1:80", "host:", ":80x", "unix:"}) {
    EXPECT_EQ(other.open(address).code(), StatusCode::kInvalidArgument) << address;
  }
}

TEST(PoseStream, AddressesAreSplit) {
  std::string host;
  int port = 0;
  ASSERT_TRUE(split_address("8080", host, port));
  EXPECT_EQ(host + " " + std::to_string(port), "127.0.0.1 8080");
  ASSERT_TRUE(split_address("0.0.0.0:80", host, port));
  EXPECT_EQ(host + " " + std::to_string(port), "0.0.0.0 80");
  ASSERT_TRUE(split_address("[::1]:9", host, port));
  EXPECT_EQ(host + " " + std::to_string(port), "::1 9");
}

TEST(BoundedWriter, FullPipeNeverBlocksAndClosedPipeIsGone) {
  int ends[2] = {-1, -1};
  ASSERT_EQ(::pipe2(ends, O_CLOEXEC), 0);
  ::signal(SIGPIPE, SIG_IGN);
  BoundedWriter writer(ends[1], false, true, 4096);
  const std::string line(999, 'x');
  for (int n = 0; n < 200; ++n)
    ASSERT_TRUE(writer.write(line + '\n'));  // the pipe takes 64 KiB, the buffer 4
  EXPECT_GT(writer.dropped(), 100u);
  const std::string text = read_all(ends[0]);
  EXPECT_GE(text.size(), 60'000u);
  writer.drain(1000);
  EXPECT_EQ((text.size() + read_all(ends[0]).size()) % 1000, 0u);
  ::close(ends[0]);
  EXPECT_FALSE(writer.write(line));
  EXPECT_TRUE(writer.gone());
}

}  // namespace
}  // namespace plvo
