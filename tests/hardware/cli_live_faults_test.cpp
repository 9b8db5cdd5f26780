// SPDX-License-Identifier: Apache-2.0
// What goes wrong while `plvo live` runs: it says so, waits, and goes on when frames do; files stay whole.
#include <netinet/in.h>
#include <sys/socket.h>

#include <nlohmann/json.hpp>
#include <sstream>
#include <vector>

#include "live_command.hpp"

namespace plvo_test {
namespace {

class CliLiveFaults : public LiveCommand {
 protected:
  void start_live(const std::string& more = "") {
    start("live --out " + path("t.txt") + " --stats " + path("s.csv") + " --json " + path("j.json") + ' ' +
          more);
    ASSERT_TRUE(says("Ctrl-C ends")) << err();
    wait_for_rows(10);
  }
  // Until the statistics have this many frames.
  void wait_for_rows(long rows) const {
    eventually([&] { return lines_in(read_file(path("s.csv"))) > rows; });
    EXPECT_GT(lines_in(read_file(path("s.csv"))), rows) << err();
  }
  long rows() const { return lines_in(read_file(path("s.csv"))) - 1; }
  nlohmann::json summary() const { return nlohmann::json::parse(read_file(path("j.json"))); }
  // The third column of the statistics.
  std::vector<std::string> states() const {
    std::vector<std::string> states;
    std::istringstream rows(read_file(path("s.csv")));
    std::string row, word;
    for (std::getline(rows, row); std::getline(rows, row);) {
      std::istringstream columns(row);
      for (int i = 0; i < 3; ++i) std::getline(columns, word, ',');
      states.push_back(word);
    }
    return states;
  }
  void expect_whole_files() const {
    const nlohmann::json json = summary();
    EXPECT_EQ(rows(), json["frames"].get<long>());
    const std::string poses = read_file(path("t.txt"));
    EXPECT_EQ(lines_in(poses) - 1, json["tracked"].get<long>() + json["initialised"].get<long>());
    EXPECT_EQ(poses.back(), '\n');
  }
};

TEST_F(CliLiveFaults, UnplugAndReplug) {
  start_live();
  for (int round = 1; round <= 2; ++round) {
    tell_device("unplug");
    eventually([&] { return contains(err(), "was unplugged; plug it in again"); });
    pause(0.3);
    const long before = rows();
    tell_device("plug");
    wait_for_rows(before + 10);
    eventually([&] { return states().back() == "tracking"; });
  }
  EXPECT_EQ(interrupt(), 0) << err();
  EXPECT_TRUE(contains(err(), "plvo: warning: Virtual RGB-D was unplugged; plug it in again to go on"))
      << err();
  EXPECT_TRUE(contains(err(), "Virtual RGB-D is back")) << err();
  EXPECT_TRUE(contains(err(), "frames come again, after")) << err();
  EXPECT_EQ(summary()["camera_counters"]["unplugged"], 2);
  EXPECT_EQ(summary()["camera_counters"]["replugged"], 2);
  EXPECT_EQ(summary()["interrupted"], true);
  EXPECT_EQ(states().back(), "tracking");
  expect_whole_files();
  EXPECT_TRUE(contains(out(), "ended by Ctrl-C")) << out();
}

TEST_F(CliLiveFaults, SilenceOfOneStreamOrBoth) {
  start_live();
  for (const auto& [command, words] : {std::pair("stop depth", "the depth stream stopped"),
                                       std::pair("stop colour", "the colour stream stopped"),
                                       std::pair("stall", "no frames from Virtual RGB-D")}) {
    tell_device(command);
    EXPECT_TRUE(says(words)) << command << ": " << err();
    const long before = rows();
    tell_device("run");
    wait_for_rows(before + 5);
  }
  // The pattern has moved on meanwhile: it may be lost and start anew first.
  eventually([&] { return states().back() == "tracking"; });
  EXPECT_EQ(states().back(), "tracking");
  EXPECT_EQ(interrupt(), 0) << err();
  expect_whole_files();
}

TEST_F(CliLiveFaults, CoveredCameraIsLostAndComesBack) {
  start_live();
  for (const char* cover : {"dark", "zero_depth"}) {
    tell_device(std::string(cover) + " 1");
    long seen = rows();
    eventually([&] { return !states().empty() && states().back() == "lost"; });
    EXPECT_EQ(states().back(), "lost") << cover;
    seen = rows();
    wait_for_rows(seen + 5);
    tell_device(std::string(cover) + " 0");
    eventually([&] { return states().back() == "tracking"; });
    EXPECT_EQ(states().back(), "tracking") << cover;
  }
  EXPECT_EQ(interrupt(), 0) << err();
  EXPECT_GE(summary()["lost"].get<int>(), 10);
  EXPECT_GE(summary()["lost_reasons"]["too_few_features"].get<int>(), 10) << summary();
  expect_whole_files();
}

TEST_F(CliLiveFaults, DiskFullWhileRecordingEndsTheRecordingAlone) {
  // No file may grow beyond 8 KiB: black images fit, a test pattern does not.
  start("live --stats " + path("s.csv") + " --record " + path("walk") + " --json " + path("j.json"),
        device("dark 1;zero_depth 1"), "ulimit -f 16; ");
  eventually([&] { return lines_in(read_file(path("walk/rgb.txt"))) >= 8; });
  tell_device("dark 0");
  tell_device("zero_depth 0");
  EXPECT_TRUE(says("plvo: error: the recording ends here, what was written is whole: cannot write")) << err();
  const auto wait_for_frames = rows();
  wait_for_rows(wait_for_frames + 5);
  EXPECT_EQ(interrupt(), 1) << err();
  EXPECT_EQ(states().back(), "tracking") << "the odometry went on";
  const long listed = lines_in(read_file(path("walk/rgb.txt"))) - 1;
  EXPECT_GE(listed, 7);
  EXPECT_EQ(summary()["recording"]["frames"], listed);
  EXPECT_EQ(lines_in(read_file(path("walk/depth.txt"))) - 1, listed);
  const auto replay = plvo("run " + path("walk") + " --json " + path("r.json"));
  EXPECT_EQ(replay.exit_code, 3) << "dark frames, all of them readable: " << replay.err;
  EXPECT_EQ(nlohmann::json::parse(read_file(path("r.json")))["frames"], listed);
  EXPECT_EQ(nlohmann::json::parse(read_file(path("r.json")))["damaged"], 0);
}

TEST_F(CliLiveFaults, ViewersAndReadersThatNeverReadCostNothing) {
  // A send that waited would wait two seconds, for each of twelve viewers and readers, in each of 120 frames:
  // beyond all patience.
  start("live --frames 120 --view 0 --stream 0 --json " + path("j.json"));
  ASSERT_TRUE(says("Ctrl-C ends")) << err();
  std::vector<int> sockets;
  for (const char* word : {"live view: http://127.0.0.1:", "poses: 127.0.0.1:"}) {
    const std::size_t at = err().find(word);
    ASSERT_NE(at, std::string::npos) << err();
    const int port = std::atoi(err().c_str() + at + std::string(word).size());
    for (int i = 0; i < 6; ++i) {
      const int fd = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
      const int small = 1024;
      ::setsockopt(fd, SOL_SOCKET, SO_RCVBUF, &small, sizeof small);
      sockaddr_in to{};
      to.sin_family = AF_INET;
      to.sin_port = htons(static_cast<std::uint16_t>(port));
      to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
      ASSERT_EQ(::connect(fd, reinterpret_cast<sockaddr*>(&to), sizeof to), 0);
      const std::string ask = "GET /update?after=0&image=0 HTTP/1.1\r\nHost: localhost\r\n\r\n";
      for (int n = 0; n < 20; ++n) ::send(fd, ask.data(), ask.size(), MSG_NOSIGNAL);
      sockets.push_back(fd);  // and nobody ever reads from it
    }
  }
  EXPECT_EQ(wait(), 0) << err();
  for (const int fd : sockets) ::close(fd);
  const nlohmann::json json = summary();
  EXPECT_GE(json["frames"].get<int>(), 120);
}

}  // namespace
}  // namespace plvo_test
