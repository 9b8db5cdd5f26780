// SPDX-License-Identifier: Apache-2.0
// The client of docs/user/pose_stream.md reads the pose stream.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "plvo/host/stream/pose_stream.hpp"
#include "temporary_folder.hpp"

namespace plvo {
namespace {

struct PoseClient : testing::Test {
  // patience_s: for the next line; the page's client has two seconds.
  void start(int patience_s) {
    std::string program = test::read_file(std::getenv("PLVO_POSE_CLIENT"));
    const std::string patience = "timeout=2)";
    ASSERT_NE(program.find(patience), std::string::npos);
    program.replace(program.find(patience), patience.size(), "timeout=" + std::to_string(patience_s) + ")");
    test::write_file(folder / "pose_client.py", program);
    ASSERT_TRUE(stream.open("0").ok());
    const std::string command = "exec python3 '" + (folder / "pose_client.py").string() + "' " +
                                std::to_string(stream.port()) + " 2>&1";
    client = ::popen(command.c_str(), "r");
    ASSERT_NE(client, nullptr);
    while (stream.readers() == 0) ASSERT_TRUE(stream.write_heartbeat({"waiting", -1, "no frame yet"}).ok());
  }

  // What the client printed until it ended, and its exit code.
  std::string ending(int& exit_code) {
    std::string text;
    std::array<char, 4096> bytes{};
    while (std::size_t got = std::fread(bytes.data(), 1, bytes.size(), client))
      text.append(bytes.data(), got);
    exit_code = WEXITSTATUS(::pclose(client));
    return text;
  }

  test::TemporaryFolder folder;
  PoseStream stream;
  std::FILE* client = nullptr;
};

TEST_F(PoseClient, PrintsPosesLossesAndHeartbeats) {
  start(600);
  TrackResult result;
  result.state = TrackState::kTracking;
  result.stamp_ns = 1'600'000'001'033'333'000;
  result.T_world_camera.t = Vector3(1.5, -2, 0.25);
  result.pose_covariance = Matrix6::Identity() * 4;
  ASSERT_TRUE(stream.write(result).ok());
  result.state = TrackState::kLost;
  result.status = {StatusCode::kTooFewFeatures, "lost: dark"};
  result.stamp_ns += 1;
  ASSERT_TRUE(stream.write(result).ok());
  ASSERT_TRUE(stream.write_heartbeat({"stalled", 1.5, "no frames"}).ok());
  stream.close();
  int exit_code = -1;
  const std::string text = ending(exit_code);
  EXPECT_EQ(exit_code, 0);
  EXPECT_TRUE(
      text.ends_with("1600000001033333000 position [1.5, -2, 0.25] m, to [2.0, 2.0, 2.0]\n"
                     "1600000001033333001 lost: dark\n"
                     "no frame: stalled no frames\n"))
      << text;
}

TEST_F(PoseClient, EndsWhenPlvoHangs) {
  start(2);
  int exit_code = -1;
  const std::string text = ending(exit_code);
  EXPECT_EQ(exit_code, 1);
  EXPECT_TRUE(text.ends_with("plvo says nothing: stop the robot\n")) << text;
}

}  // namespace
}  // namespace plvo
