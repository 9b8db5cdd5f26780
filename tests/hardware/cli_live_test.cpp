// SPDX-License-Identifier: Apache-2.0
// `plvo live` with the real OpenNI2 and a virtual device: the poses equal those from files, byte for byte.
// Also tests the output of each way of ending.
#include <netinet/in.h>
#include <sys/socket.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "live_command.hpp"

namespace plvo_test {
namespace {

using plvo::test::CommandResult;

const std::string kSmall = "--mode 320x240 ";

class CliLive : public LiveCommand {
 protected:
  // The same 12 simulated frames for the device (raw) and as a folder (sequence).
  void make_recording() {
    const CommandResult made = run_command(std::string(PLVO_VIRTUAL_FRAMES_BINARY) + ' ' + path("raw") + ' ' +
                                           path("sequence") + " 12");
    ASSERT_EQ(made.exit_code, 0) << made.err;
  }
  std::string files(const std::string& name) const {
    return " --quiet --out " + path(name) + ".txt --covariance " + path(name) + ".cov --motions " +
           path(name) + ".mot";
  }
  // Runs live on the 12 frames. The device shows each frame when the pose of the previous one has been
  // written, so none is lost, whatever the load of the machine. The poses go to standard output.
  int live_over_recording(const std::string& arguments) {
    start("live " + kSmall + "--calibration " + path("sequence/calibration.txt") +
              " --every-frame --frames 12 --stream - " + arguments,
          device("allow 1", path("raw")));
    for (long pose = 1; pose < 12; ++pose) {
      if (!comes_true([&] { return poses_in(out()) == pose; })) return -1;
      tell_device("allow 1");
    }
    return wait();
  }
  static long poses_in(const std::string& stream) {
    long poses = 0;
    for (std::size_t at = 0; (at = stream.find("\"position\"", at)) != std::string::npos; ++at) ++poses;
    return poses;
  }
  void expect_same(const std::string& a, const std::string& b, long poses) const {
    for (const char* end : {".txt", ".cov", ".mot"}) {
      const std::string one = read_file(path(a + end));
      EXPECT_EQ(one, read_file(path(b + end))) << a << " and " << b << ": " << end;
      EXPECT_EQ(lines_in(one), end == std::string(".mot") ? poses : poses + 1);
    }
  }
};

TEST_F(CliLive, GivesTheSamePosesAsRunOnTheSameFramesFromFiles) {
  make_recording();
  ASSERT_EQ(plvo("run " + path("sequence") + files("files")).exit_code, 0);
  ASSERT_EQ(live_over_recording("--record " + path("again") + files("live")), 0) << err();
  expect_same("files", "live", 12);
  // The recording of the session gives the same poses again.
  ASSERT_EQ(plvo("run " + path("again") + files("again")).exit_code, 0);
  expect_same("files", "again", 12);
}

TEST_F(CliLive, PosesOfTheRobotsBaseAreThoseOfRun) {
  make_recording();
  const std::string place = " --base-camera 0.2 -0.1 0.5 -0.5 0.5 -0.5 0.5";
  ASSERT_EQ(plvo("run " + path("sequence") + files("files") + place).exit_code, 0);
  ASSERT_EQ(live_over_recording(files("live") + place), 0) << err();
  expect_same("files", "live", 12);
  std::istringstream stream(out());
  std::istringstream file(read_file(path("live.txt")));
  std::string row;
  std::getline(file, row);
  EXPECT_NE(row.find("frame_id: odom, child_frame_id: base_link"), std::string::npos) << row;
  int poses = 0;
  for (std::string line; std::getline(stream, line);) {
    const auto json = nlohmann::json::parse(line);
    if (json.contains("heartbeat")) continue;
    EXPECT_EQ(json["frame_id"], "odom");
    EXPECT_EQ(json["child_frame_id"], "base_link");
    double stamp = 0;
    ASSERT_TRUE(file >> stamp);
    for (const auto* part : {"position", "orientation_xyzw"})
      for (const auto& told : json[part]) {
        double written = 0;
        ASSERT_TRUE(file >> written);
        EXPECT_NEAR(told.get<double>(), written, 2e-9);
      }
    ++poses;
  }
  EXPECT_EQ(poses, 12);
}

// Depth as a camera beside that of colour sees it.
TEST_F(CliLive, RegistersDepthOfAnotherCameraAsRunDoes) {
  make_recording();
  ASSERT_EQ(plvo("run " + path("sequence") + files("as_one")).exit_code, 0);
  const std::string calibration = read_file(path("sequence/calibration.txt"));
  plvo::test::write_file(path("sequence/calibration.txt"), calibration + "depth_tx 0.015\n");
  ASSERT_EQ(plvo("run " + path("sequence") + files("files")).exit_code, 0);
  EXPECT_NE(read_file(path("files.txt")), read_file(path("as_one.txt")));
  ASSERT_EQ(live_over_recording("--record " + path("again") + files("live")), 0) << err();
  expect_same("files", "live", 12);
  // The recording has registered depth.
  ASSERT_EQ(plvo("run " + path("again") + files("again")).exit_code, 0);
  expect_same("files", "again", 12);
}

TEST_F(CliLive, ADepthCameraForDepthThatIsRegisteredIsRefused) {
  ASSERT_EQ(plvo("record " + path("a.oni") + " --quiet --frames 2 " + kSmall).exit_code, 0);
  plvo::test::write_file(path("c.txt"), "262 262 159.5 119.5 1000\ndepth_tx 0.02\n");
  const CommandResult r =
      plvo("live --device " + path("a.oni") + " --frames 1 --calibration " + path("c.txt"));
  EXPECT_EQ(r.exit_code, 1) << r.err;
  EXPECT_NE(r.err.find("has registered depth: leave depth_fx"), std::string::npos) << r.err;
}

TEST_F(CliLive, AnOniFileAndTheFolderMadeFromItGiveTheSamePoses) {
  ASSERT_EQ(plvo("record " + path("a.oni") + " --quiet --seconds 1.2 " + kSmall).exit_code, 0);
  const CommandResult live = plvo("live --device " + path("a.oni") + files("oni"));
  ASSERT_EQ(live.exit_code, 0) << live.err;
  const long poses = lines_in(read_file(path("oni.txt"))) - 1;
  EXPECT_GT(poses, 10);
  ASSERT_EQ(plvo("run " + path("a.oni") + files("run")).exit_code, 0);
  expect_same("oni", "run", poses);
  ASSERT_EQ(plvo("run " + path("a.oni") + " --frames 2:7" + files("part")).exit_code, 0);
  EXPECT_EQ(lines_in(read_file(path("part.txt"))) - 1, 5);
  ASSERT_EQ(plvo("record " + path("folder") + " --quiet --device " + path("a.oni")).exit_code, 0);
  ASSERT_EQ(plvo("run " + path("folder") + files("folder")).exit_code, 0);
  expect_same("oni", "folder", poses);
}

TEST_F(CliLive, StandardOutputAsStreamCarriesOnlyPosesAndHeartbeats) {
  const CommandResult r = plvo("live --frames 8 --every-frame --stream - --stream unix:" + path("socket"));
  ASSERT_EQ(r.exit_code, 0) << r.err;
  std::istringstream lines(r.out);
  std::int64_t last_ns = -1;
  int poses = 0;
  for (std::string line; std::getline(lines, line);) {
    const auto json = nlohmann::json::parse(line);
    if (json.contains("heartbeat")) continue;  // appears if frames take long
    EXPECT_GT(json["stamp_ns"].get<std::int64_t>(), last_ns);
    last_ns = json["stamp_ns"];
    ++poses;
  }
  EXPECT_EQ(poses, 8) << r.out;
  EXPECT_EQ(r.out.back(), '\n');
  EXPECT_TRUE(contains(r.err, "latency")) << "the summary goes where it disturbs nobody: " << r.err;
  EXPECT_FALSE(std::filesystem::exists(path("socket"))) << "tidied away";
}

TEST_F(CliLive, EndsWhenItsOnlyReaderLeaves) {
  const CommandResult r = run_command("sh -c '" + kPlvo + " live --seconds 30 --stream - | head -n 3'");
  EXPECT_EQ(lines_in(r.out), 3);
  EXPECT_TRUE(contains(r.err, "standard output was closed")) << r.err;
  EXPECT_FALSE(contains(r.err, "time                   30")) << "long before its time: " << r.err;
}

TEST_F(CliLive, FrameBudgetReducesTheFeatures) {
  const CommandResult r = plvo("live --frames 8 --every-frame --frame-budget 0.001 --json " + path("j"));
  EXPECT_EQ(r.exit_code, 0) << r.err;
  EXPECT_EQ(nlohmann::json::parse(read_file(path("j")))["fewer_features"]["frames"], 7);
}

TEST_F(CliLive, ChosenRateDropsOldFramesAndCountsThem) {
  const CommandResult r = plvo("live --max-rate 5 --frames 8 " + kSmall + "--json " + path("j"));
  ASSERT_EQ(r.exit_code, 0) << r.err;
  const auto json = nlohmann::json::parse(read_file(path("j")));
  const int frames = json["frames"], dropped = json["dropped"], captured = json["camera_frames"];
  EXPECT_EQ(frames, 8);
  // A late frame is compensated at once by the next one, so at least every second interval has its full
  // length.
  EXPECT_GE(json["seconds"].get<double>(), 0.6) << "eight frames at five a second";
  EXPECT_GT(dropped, 0) << "the newest frame wins";
  // Each captured frame was tracked, was dropped, or lies in the ring (one slot being written, one ready).
  EXPECT_LE(frames + dropped, captured);
  EXPECT_GE(frames + dropped, captured - 4);
}

TEST_F(CliLive, ErrorsGiveAnExitCodeAndOneLine) {
  const auto expect = [](const CommandResult& r, int code, const std::string& words) {
    EXPECT_EQ(r.exit_code, code) << words << ": " << r.err;
    const std::size_t at = r.err.rfind("plvo: error: ");
    ASSERT_NE(at, std::string::npos) << r.err;
    EXPECT_TRUE(contains(r.err.substr(at), words)) << r.err;
    EXPECT_EQ(lines_in(r.err.substr(at)), 1) << r.err;
  };
  expect(plvo("live", device("unplug")), 4, "no sensor: none is plugged in");
  expect(plvo("live --device freenect://9-9"), 4, "freenect://9-9");
  expect(plvo("live --device " + path("none.oni")), 1, "there is no file");
  expect(plvo("live --mode 1280x1024@15"), 1, "this device offers");
  expect(plvo("live --calibration " + path("none.txt")), 1, "none.txt");
  expect(plvo("live --out " + path("no/such/folder.txt")), 1, "choose a path that can be written");
  expect(plvo("live --record " + path("no/such/folder")), 1, "cannot make the folder");
  expect(plvo("live --stream nonsense"), 2, "--stream: expected [ADDRESS:]PORT");
  expect(plvo("live --view nonsense"), 2, "--view: expected [ADDRESS:]PORT");
  expect(plvo("live --seconds 1.5", device("stall")), 4, "no frame came from Virtual RGB-D");
  expect(plvo("live --frames 10 --quiet", device("dark 1;zero_depth 1")), 3, "no frame could be tracked: ");
  EXPECT_EQ(plvo("live --mode big").exit_code, 2);
  EXPECT_EQ(plvo("live --max-rate 0").exit_code, 2);
  EXPECT_EQ(plvo("live --view-host robot.local").exit_code, 2) << "of which view?";
  EXPECT_EQ(plvo("live --view 0 --view-host http://robot/").exit_code, 2);
  EXPECT_EQ(plvo("live --depth-scale 1000").exit_code, 2);
}

TEST_F(CliLive, AddressInUseKeepsTheOldTrajectory) {
  const int fd = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in here{};
  here.sin_family = AF_INET;
  here.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof here;
  ASSERT_EQ(::bind(fd, reinterpret_cast<sockaddr*>(&here), size), 0);
  ASSERT_EQ(::listen(fd, 1), 0);
  ::getsockname(fd, reinterpret_cast<sockaddr*>(&here), &size);
  const std::string port = std::to_string(ntohs(here.sin_port));
  plvo::test::write_file(path("old.txt"), "yesterday's poses\n");
  for (const char* option : {" --view ", " --stream "}) {
    const CommandResult r = plvo("live --out " + path("old.txt") + option + port);
    EXPECT_EQ(r.exit_code, 1);
    EXPECT_TRUE(contains(r.err, "in use")) << r.err;
    EXPECT_EQ(read_file(path("old.txt")), "yesterday's poses\n");
  }
  ::close(fd);
}

TEST_F(CliLive, HelpDocumentsExitCodesAndExamples) {
  for (const char* command : {"live", "record", "doctor", "tilt"}) {
    const CommandResult r = plvo(std::string(command) + " --help");
    EXPECT_EQ(r.exit_code, 0);
    EXPECT_TRUE(contains(r.out, "Exit code")) << r.out;
  }
  EXPECT_TRUE(contains(plvo("live --help").out, "plvo live --view 8080"));
}

}  // namespace
}  // namespace plvo_test
