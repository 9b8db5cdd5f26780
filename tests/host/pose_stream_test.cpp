// SPDX-License-Identifier: Apache-2.0
// Poses as JSON lines: the text itself, several readers, and readers that do not read, vanish, or come late.
#include "plvo/host/stream/pose_stream.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>

#include "loopback.hpp"
#include "plvo/host/stream/pose_json.hpp"
#include "plvo/host/stream/tcp_listener.hpp"
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

int connect_unix(const std::string& path) {
  const int fd = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_un to{};
  to.sun_family = AF_UNIX;
  std::memcpy(to.sun_path, path.c_str(), path.size() + 1);
  EXPECT_EQ(::connect(fd, reinterpret_cast<const sockaddr*>(&to), sizeof to), 0);
  return fd;
}
// What lies there now. Pipes and Unix sockets pass on at once what was written; TCP may take a moment.
std::string read_available(int fd) {
  ::fcntl(fd, F_SETFL, ::fcntl(fd, F_GETFL) | O_NONBLOCK);
  std::string text;
  std::array<char, 4096> bytes{};
  for (ssize_t got = 0; (got = ::read(fd, bytes.data(), bytes.size())) > 0;) {
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
// The stamp of the next pose, past heartbeats, however long it takes to come; -1 at the end of the stream.
std::int64_t next_pose(int fd) {
  for (;;) {
    std::string line;
    char c = 0;
    while (::read(fd, &c, 1) == 1 && c != '\n') line += c;
    if (c != '\n') return -1;
    const nlohmann::json json = nlohmann::json::parse(line);
    if (!json.contains("heartbeat")) return json["stamp_ns"];
  }
}
// Readers are let in and forgotten when a line is written.
void until_readers_are(PoseStream& stream, std::size_t count) {
  while (stream.readers() != count) ASSERT_TRUE(stream.write_heartbeat({"waiting", -1, ""}).ok());
}

TEST(PoseJson, SaysEverything) {
  TrackResult result = sample(1'600'000'001'033'333'000);
  result.state = TrackState::kLost;
  result.status =
      Status(StatusCode::kTooFewFeatures, "only \"3\" points \\ 0 lines\nlamp off\x01 caf\xc3\xa9");
  result.world = 2;
  const nlohmann::json json = nlohmann::json::parse(pose_json(result));
  EXPECT_EQ(json["world"], 2);
  EXPECT_EQ(json["stamp_ns"].get<std::int64_t>(), 1'600'000'001'033'333'000);
  EXPECT_EQ(json["state"], to_string(TrackState::kLost));
  EXPECT_EQ(json["status"], "too_few_features");
  EXPECT_EQ(json["message"], "only \"3\" points \\ 0 lines lamp off? caf??");
  EXPECT_EQ(json["frame_id"], "world_optical");
  EXPECT_EQ(json["child_frame_id"], "camera_optical");
  EXPECT_NEAR(json["position"][1].get<double>(), -2, 1e-9);
  EXPECT_NEAR(json["orientation_xyzw"][2].get<double>(), std::sin(0.5), 1e-8);
  ASSERT_EQ(json["covariance"].size(), 36u);
  EXPECT_NEAR(json["covariance"][7].get<double>(), 1e-6, 1e-15);
  EXPECT_EQ(json["points"]["inliers"], 42);
  EXPECT_EQ(json["lines"]["matched"], 7);
}

TEST(PoseJson, SaysWhoseFramesTheyAre) {
  const nlohmann::json json = nlohmann::json::parse(pose_json(sample(1), kBaseFrames));
  EXPECT_EQ(json["frame_id"], "odom");
  EXPECT_EQ(json["child_frame_id"], "base_link");
}

TEST(PoseJson, SaysWhatTheMapKnows) {
  EXPECT_FALSE(nlohmann::json::parse(pose_json(sample(1))).contains("map"));
  MapPose map;
  map.T_map_world = {rotation_exp(Vector3(0, 1, 0)), Vector3(3, 4, 5)};
  map.pose_covariance = Matrix6::Identity() * 1e-4;
  map.loops = 7;
  const nlohmann::json lost = nlohmann::json::parse(pose_json(sample(1), kCameraFrames, &map))["map"];
  EXPECT_EQ(lost["located"], false);
  EXPECT_EQ(lost["loops"], 7);
  for (const char* member : {"position", "orientation_xyzw", "covariance"})
    EXPECT_TRUE(lost[member].is_null()) << member;
  map.located = true;
  const nlohmann::json found = nlohmann::json::parse(pose_json(sample(1), kCameraFrames, &map))["map"];
  EXPECT_EQ(found["located"], true);
  EXPECT_EQ(found["position"], nlohmann::json({3.0, 4.0, 5.0}));
  EXPECT_NEAR(found["orientation_xyzw"][1].get<double>(), std::sin(0.5), 1e-8);
  EXPECT_NEAR(found["covariance"][7].get<double>(), 1e-4, 1e-12);
}

TEST(PoseJson, NumbersThatJsonDoesNotKnowBecomeNull) {
  TrackResult result = sample(1);
  result.T_world_camera.t.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(nlohmann::json::parse(pose_json(result))["position"][0].is_null());
}

TEST(PoseJson, AHeartbeatTellsAStallFromAHang) {
  const auto stalled = nlohmann::json::parse(heartbeat_json({"stalled", 1.25, "no frames from \"it\""}));
  EXPECT_EQ(stalled["heartbeat"], true);
  EXPECT_EQ(stalled["state"], "stalled");
  EXPECT_EQ(stalled["seconds_since_frame"], 1.25);
  EXPECT_EQ(stalled["message"], "no frames from \"it\"");
  EXPECT_TRUE(nlohmann::json::parse(heartbeat_json({"waiting", -1, ""}))["seconds_since_frame"].is_null());
}

TEST(PoseStream, SeveralTcpReadersEachGetEveryLineSinceTheyCame) {
  PoseStream stream;
  ASSERT_TRUE(stream.open("0").ok());
  ASSERT_TRUE(stream.write(sample(1)).ok());  // nobody listens: nothing happens
  const int first = test::connect_loopback(stream.port());
  until_readers_are(stream, 1);
  ASSERT_TRUE(stream.write(sample(2)).ok());
  const int second = test::connect_loopback(stream.port());
  until_readers_are(stream, 2);
  ASSERT_TRUE(stream.write(sample(3)).ok());
  EXPECT_EQ(next_pose(first), 2);
  EXPECT_EQ(next_pose(first), 3);
  EXPECT_EQ(next_pose(second), 3);
  ::close(first);
  until_readers_are(stream, 1);
  for (int n = 4; n < 8; ++n) ASSERT_TRUE(stream.write(sample(n)).ok());
  for (int n = 4; n < 8; ++n) EXPECT_EQ(next_pose(second), n);
  stream.close();
  EXPECT_EQ(next_pose(second), -1);
  ::close(second);
}

// One thread writes and reads here: a write that waited for the stuck reader would never return.
TEST(PoseStream, ReaderThatNeverReadsCostsNothingAndLosesWholeLines) {
  test::TemporaryFolder folder;
  const std::string path = (folder / "poses").string();
  PoseStream stream;
  ASSERT_TRUE(stream.open("unix:" + path).ok());
  const int stuck = connect_unix(path);
  const int good = connect_unix(path);
  std::size_t got = 0;
  for (int n = 0; n < 500; ++n) {
    ASSERT_TRUE(stream.write(sample(n)).ok());
    if (n % 10 == 9) got += lines_of(read_available(good)).size();
  }
  EXPECT_GT(stream.dropped_lines(), 0u);
  EXPECT_EQ(got, 500u);  // the other reader missed nothing
  stream.close();
  lines_of(read_available(stuck));  // no line is cut, what came is whole
  ::close(stuck);
  ::close(good);
}

TEST(PoseStream, IdleConnectionsLockNobodyOut) {
  PoseStream stream;
  ASSERT_TRUE(stream.open("0").ok());
  std::vector<int> idle;
  for (int round = 0; round < 3; ++round) {
    for (int i = 0; i < 40; ++i) idle.push_back(test::connect_loopback(stream.port()));
    until_readers_are(stream, PoseReaders::kMaxPerAddress);
    const int first = test::connect_loopback(stream.port());
    const int second = test::connect_loopback(stream.port());
    // Once each has got a pose it has its place, and gets every one from then on.
    std::int64_t stamp = 0;
    for (const int fd : {first, second}) {
      pollfd one{fd, POLLIN, 0};
      while (::poll(&one, 1, 100) == 0) ASSERT_TRUE(stream.write(sample(++stamp)).ok());
    }
    std::int64_t of_first = next_pose(first), of_second = next_pose(second);
    for (const std::int64_t end = stamp + 20; stamp < end;) ASSERT_TRUE(stream.write(sample(++stamp)).ok());
    while (of_first < stamp) ASSERT_EQ(next_pose(first), ++of_first);
    while (of_second < stamp) ASSERT_EQ(next_pose(second), ++of_second);
    ::close(first);
    ::close(second);
  }
  for (const int fd : idle) ::close(fd);
}

TEST(PoseStream, AReaderThatReadsOutlastsAnyNumberOfIdleConnections) {
  PoseStream stream;
  ASSERT_TRUE(stream.open("0").ok());
  const int robot = test::connect_loopback(stream.port());
  until_readers_are(stream, 1);
  std::int64_t stamp = 0;
  for (std::size_t bytes = 0; bytes <= PoseReaders::kProvenBytes; bytes += pose_json(sample(stamp)).size()) {
    ASSERT_TRUE(stream.write(sample(++stamp)).ok());
    ASSERT_EQ(next_pose(robot), stamp);
  }
  std::vector<int> idle;
  for (int i = 0; i < 100; ++i) {
    idle.push_back(test::connect_loopback(stream.port()));
    ASSERT_TRUE(stream.write(sample(++stamp)).ok());
    ASSERT_EQ(next_pose(robot), stamp);
  }
  EXPECT_EQ(stream.readers(), PoseReaders::kMaxPerAddress);
  ::close(robot);
  for (const int fd : idle) ::close(fd);
}

TEST(PoseStream, BytesBufferedByTheSystemDoNotCountAsRead) {
  PoseStream stream;
  ASSERT_TRUE(stream.open("0").ok());
  const int idle = test::connect_loopback(stream.port());
  until_readers_are(stream, 1);
  std::size_t bytes = 0;
  for (std::int64_t stamp = 0; stream.dropped_lines() == 0; ++stamp) {
    ASSERT_TRUE(stream.write(sample(stamp)).ok());
    bytes += pose_json(sample(stamp)).size() + 1;
  }
  EXPECT_LT(bytes, PoseReaders::kProvenBytes + PoseReaders::kBufferBytes);
  ::close(idle);
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

TEST(PoseStream, RefusesAPortInUseAndInvalidAddresses) {
  PoseStream stream;
  ASSERT_TRUE(stream.open("127.0.0.1:0").ok());
  PoseStream other;
  const Status busy = other.open(std::to_string(stream.port()));
  EXPECT_EQ(busy.code(), StatusCode::kBusy) << busy.message();
  for (const char* address : {"", "seven", "70000", "-1", "::1:80", "host:", ":80x", "unix:"}) {
    EXPECT_EQ(other.open(address).code(), StatusCode::kInvalidArgument) << address;
  }
}

TEST(TcpListener, NamesThatOnlyLookLikeLoopbackAreNotLoopback) {
  for (const char* here : {"localhost", "127.0.0.1", "127.8.9.1", "::1", "[::1]"})
    EXPECT_TRUE(is_loopback(here)) << here;
  for (const char* elsewhere :
       {"127.evil.example", "127.", "127.0.0.1.evil.example", "0.0.0.0", "::", "10.0.0.1", ""})
    EXPECT_FALSE(is_loopback(elsewhere)) << elsewhere;
}

TEST(TcpListener, AddressesAreSplit) {
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
  const std::string text = read_available(ends[0]);
  EXPECT_GE(text.size(), 60'000u);
  writer.drain(10'000);
  EXPECT_EQ((text.size() + read_available(ends[0]).size()) % 1000, 0u);
  ::close(ends[0]);
  EXPECT_FALSE(writer.write(line));
  EXPECT_TRUE(writer.gone());
}

}  // namespace
}  // namespace plvo
