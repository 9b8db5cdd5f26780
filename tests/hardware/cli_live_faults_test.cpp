// SPDX-License-Identifier: Apache-2.0
// Faults while `plvo live` runs: it reports the fault, waits, and continues when frames arrive again; its
// files stay complete.
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/un.h>

#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>
#include <vector>

#include "live_command.hpp"

namespace plvo_test {
namespace {

long count_of(const std::string& text, const std::string& words) {
  long count = 0;
  for (std::size_t at = 0; (at = text.find(words, at)) != std::string::npos; ++at) ++count;
  return count;
}

// Reads lines from a Unix socket, each as soon as it is complete.
class LineReader {
 public:
  explicit LineReader(const std::string& path) : fd_(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_un to{};
    to.sun_family = AF_UNIX;
    path.copy(to.sun_path, sizeof to.sun_path - 1);
    EXPECT_EQ(::connect(fd_, reinterpret_cast<const sockaddr*>(&to), sizeof to), 0);
  }
  ~LineReader() { ::close(fd_); }
  LineReader(const LineReader&) = delete;
  LineReader& operator=(const LineReader&) = delete;
  std::string next() {
    std::string line;
    char c = 0;
    while (::read(fd_, &c, 1) == 1 && c != '\n') line += c;
    if (c != '\n') throw std::runtime_error("the stream has ended");
    return line;
  }

 private:
  int fd_;
};

class CliLiveFaults : public LiveCommand {
 protected:
  void start_live(const std::string& more = "", const std::string& environment = "", long first_rows = 10) {
    start("live --out " + path("t.txt") + " --stats " + path("s.csv") + " --json " + path("j.json") + ' ' +
              more,
          environment);
    ASSERT_TRUE(says("Ctrl-C ends")) << err();
    wait_for_rows(first_rows);
  }
  // Waits until the statistics contain this number of frames.
  void wait_for_rows(long least) const {
    EXPECT_TRUE(comes_true([&] { return rows() >= least; })) << err();
  }
  // Waits until the newest frame has this state; false if it does not happen in time.
  bool reaches(const std::string& state) const {
    return comes_true([&] { return !states().empty() && states().back() == state; });
  }
  long rows() const { return lines_in(read_file(path("s.csv"))) - 1; }
  nlohmann::json summary() const { return nlohmann::json::parse(read_file(path("j.json"))); }
  // The third column of the statistics: the states.
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
    EXPECT_EQ(lines_in(poses) - 1,
              json["tracked"].get<long>() + json["repeated"].get<long>() + json["initialised"].get<long>());
    EXPECT_EQ(poses.back(), '\n');
  }
};

TEST_F(CliLiveFaults, TracksAgainWhenTheSensorIsReplugged) {
  start_live();
  for (int round = 1; round <= 2; ++round) {
    tell_device("unplug");
    EXPECT_TRUE(comes_true([&] { return count_of(err(), "was unplugged; plug it in again") == round; }))
        << err();
    const long before = rows();
    tell_device("plug");
    wait_for_rows(before + 10);
    EXPECT_TRUE(reaches("tracking"));
  }
  EXPECT_EQ(interrupt(), 0) << err();
  EXPECT_TRUE(contains(err(), "plvo: warning: Virtual RGB-D was unplugged; plug it in again to go on"))
      << err();
  EXPECT_TRUE(contains(err(), "Virtual RGB-D is back")) << err();
  EXPECT_TRUE(contains(err(), "frames arrive again, after")) << err();
  EXPECT_EQ(summary()["camera_counters"]["unplugged"], 2);
  EXPECT_EQ(summary()["camera_counters"]["replugged"], 2);
  EXPECT_EQ(summary()["interrupted"], true);
  expect_whole_files();
  EXPECT_TRUE(contains(out(), "ended by a signal")) << out();
}

TEST_F(CliLiveFaults, ASensorWithoutAnAccelerometerIsTrackedWithoutGravity) {
  const plvo::test::CommandResult r =
      plvo("live --imu --mode 320x240 --frames 5 --json " + path("j.json") + " --record " + path("kept"));
  EXPECT_EQ(r.exit_code, 0) << r.err;
  EXPECT_EQ(count_of(r.err, "a Kinect v1 is the only live sensor whose accelerometer is read"), 1) << r.err;
  EXPECT_EQ(summary()["frames"], 5);
  EXPECT_FALSE(std::filesystem::exists(path("kept/accelerometer.txt")));
}

TEST_F(CliLiveFaults, NamesTheStreamThatStoppedAndTracksAgain) {
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
  // The pattern has moved on in the meantime: tracking may be lost and start again first.
  EXPECT_TRUE(reaches("tracking"));
  EXPECT_EQ(interrupt(), 0) << err();
  expect_whole_files();
}

TEST_F(CliLiveFaults, CoveredCameraIsLostAndRecovers) {
  start_live();
  for (const char* cover : {"dark", "zero_depth"}) {
    tell_device(std::string(cover) + " 1");
    EXPECT_TRUE(reaches("lost")) << cover;
    const long seen = rows();
    wait_for_rows(seen + 5);
    tell_device(std::string(cover) + " 0");
    EXPECT_TRUE(reaches("tracking")) << cover;
  }
  EXPECT_EQ(interrupt(), 0) << err();
  EXPECT_GE(summary()["lost"].get<int>(), 10);
  EXPECT_GE(summary()["lost_reasons"]["too_few_features"].get<int>(), 10) << summary();
  expect_whole_files();
}

// The heartbeat lets a robot that reads the poses distinguish a camera that stalls from a program that hangs.
TEST_F(CliLiveFaults, HeartbeatOfThePoseStreamNamesTheCameraState) {
  start_live("--stream unix:" + path("poses"));
  LineReader robot(path("poses"));
  const auto next = [&robot] { return nlohmann::json::parse(robot.next()); };
  const auto next_heartbeat = [&next](const std::string& state) {
    nlohmann::json json;
    do json = next();
    while (!json.contains("heartbeat") || json["state"] != state);
    return json;
  };
  tell_device("stall");
  double silent_s = 0;
  for (int i = 0; i < 4; ++i) {
    const nlohmann::json beat = i == 0 ? next_heartbeat("stalled") : next();
    ASSERT_EQ(beat["heartbeat"], true) << beat;
    EXPECT_EQ(beat["state"], "stalled");
    EXPECT_TRUE(contains(beat["message"], "no frames from Virtual RGB-D")) << beat;
    // At most two a second, whatever the load of the machine.
    EXPECT_GE(beat["seconds_since_frame"].get<double>(), silent_s + (i == 0 ? 0.5 : 0.49)) << beat;
    silent_s = beat["seconds_since_frame"];
  }
  tell_device("run");
  while (next().contains("heartbeat")) {
  }
  tell_device("unplug");
  EXPECT_TRUE(contains(next_heartbeat("unplugged")["message"], "plug it in again"));
  tell_device("plug");
  while (next().contains("heartbeat")) {
  }
  EXPECT_EQ(interrupt(), 0) << err();
  expect_whole_files();
}

TEST_F(CliLiveFaults, DiskFullWhileRecordingEndsTheRecordingAlone) {
  // The size limit of a file is 8 KiB: black images fit, a test pattern does not.
  start("live --stats " + path("s.csv") + " --record " + path("sequence") + " --json " + path("j.json"),
        device("dark 1;zero_depth 1"), "ulimit -f 16; ");
  EXPECT_TRUE(comes_true([&] { return lines_in(read_file(path("sequence/rgb.txt"))) >= 8; })) << err();
  tell_device("dark 0");
  tell_device("zero_depth 0");
  EXPECT_TRUE(says("plvo: error: the recording ends here, what was written is whole: cannot write")) << err();
  wait_for_rows(rows() + 5);
  EXPECT_TRUE(reaches("tracking")) << "the odometry went on";
  EXPECT_EQ(interrupt(), 1) << err();
  const long listed = lines_in(read_file(path("sequence/rgb.txt"))) - 1;
  EXPECT_GE(listed, 7);
  EXPECT_EQ(summary()["recording"]["frames"], listed);
  EXPECT_EQ(lines_in(read_file(path("sequence/depth.txt"))) - 1, listed);
  const auto replay = plvo("run " + path("sequence") + " --json " + path("r.json"));
  EXPECT_EQ(replay.exit_code, 3) << "dark frames, all of them readable: " << replay.err;
  EXPECT_EQ(nlohmann::json::parse(read_file(path("r.json")))["frames"], listed);
  EXPECT_EQ(nlohmann::json::parse(read_file(path("r.json")))["damaged"], 0);
}

TEST_F(CliLiveFaults, ViewersAndReadersThatNeverReadCostNothing) {
  // The device shows each frame when the previous one is done, so no frame is skipped, whatever the load of
  // the machine.
  start_live("--every-frame --view 0 --stream 0", device("allow 1"), 1);
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
      const std::string ask =
          "GET /update?after=0&image=0 HTTP/1.1\r\nHost: localhost:" + std::to_string(port) + "\r\n\r\n";
      for (int n = 0; n < 20; ++n) ::send(fd, ask.data(), ask.size(), MSG_NOSIGNAL);
      sockets.push_back(fd);  // never read from
    }
  }
  // A frame that waited for one of these readers would wait forever.
  for (long row = 2; row <= 61; ++row) {
    tell_device("allow 1");
    wait_for_rows(row);
  }
  EXPECT_EQ(interrupt(), 0) << err();
  for (const int fd : sockets) ::close(fd);
  EXPECT_EQ(summary()["lost"], 0);
  expect_whole_files();
}

}  // namespace
}  // namespace plvo_test
