// SPDX-License-Identifier: Apache-2.0
// `plvo live` and `plvo record` leave complete files after each kind of termination: Ctrl-C, a supervisor's
// SIGTERM, a terminal that closes. Uses the real program, real signals and the virtual device.
#include <nlohmann/json.hpp>

#include "live_command.hpp"

namespace plvo_test {
namespace {

class CliLiveSignals : public LiveCommand {
 protected:
  void start_live(const std::string& before = "") {
    start("live --every-frame --out " + path("t.txt") + " --stats " + path("s.csv") + " --covariance " +
              path("c.txt") + " --json " + path("j.json") + " --record " + path("sequence") +
              " --stream unix:" + path("poses") + " --map 32 --map-out " + path("m.map") +
              " --map-trajectory " + path("m.txt"),
          "", before);
    EXPECT_TRUE(frames_reach(10)) << err();
  }
  bool frames_reach(long count) const {
    return comes_true([&] { return lines_in(read_file(path("s.csv"))) > count; });
  }
  // All files agree, up to their last line.
  void expect_whole_files() const {
    const nlohmann::json json = nlohmann::json::parse(read_file(path("j.json")));
    EXPECT_EQ(json["interrupted"], true);
    const long frames = json["frames"], poses = json["tracked"].get<long>() + json["repeated"].get<long>() +
                                                json["initialised"].get<long>();
    EXPECT_EQ(lines_in(read_file(path("s.csv"))), frames + 1);
    EXPECT_EQ(lines_in(read_file(path("t.txt"))), poses + 1);
    EXPECT_EQ(lines_in(read_file(path("c.txt"))), poses + 1);
    EXPECT_EQ(lines_in(read_file(path("m.txt"))), poses + 1);
    EXPECT_EQ(plvo("map " + path("m.map") + " --json " + path("map.json")).exit_code, 0);
    EXPECT_EQ(nlohmann::json::parse(read_file(path("map.json")))["keyframes"], json["map"]["keyframes"]);
    EXPECT_FALSE(std::filesystem::exists(path("m.map.part")));
    for (const char* file : {"s.csv", "t.txt", "c.txt", "m.txt"})
      EXPECT_EQ(read_file(path(file)).back(), '\n') << file;
    EXPECT_FALSE(std::filesystem::exists(path("poses"))) << "the socket is tidied away";
    expect_whole_recording(json["recording"]["frames"]);
  }
  // All files that the recording lists exist and are readable.
  void expect_whole_recording(long frames) const {
    EXPECT_EQ(lines_in(read_file(path("sequence/rgb.txt"))), frames + 1);
    EXPECT_EQ(lines_in(read_file(path("sequence/depth.txt"))), frames + 1);
    const auto replay = plvo("run " + path("sequence") + " --json " + path("r.json"));
    EXPECT_EQ(replay.exit_code, 0) << replay.err;
    const nlohmann::json json = nlohmann::json::parse(read_file(path("r.json")));
    EXPECT_EQ(json["frames"], frames);
    EXPECT_EQ(json["damaged"], 0);
  }
};

TEST_F(CliLiveSignals, WritesWholeFilesWhenInterrupted) {
  start_live();
  send(SIGINT);
  EXPECT_EQ(wait(), 0) << err();
  expect_whole_files();
}

TEST_F(CliLiveSignals, WritesWholeFilesWhenTerminated) {
  start_live();
  send(SIGTERM);
  EXPECT_EQ(wait(), 0) << err();
  expect_whole_files();
}

TEST_F(CliLiveSignals, WritesWholeFilesWhenSignalsRepeat) {
  start_live();
  send(SIGHUP);
  send(SIGHUP);
  send(SIGTERM);
  send(SIGTERM);
  EXPECT_EQ(wait(), 0) << err();
  expect_whole_files();
}

TEST_F(CliLiveSignals, NohupIgnoresHangup) {
  start_live("trap '' HUP; ");
  send(SIGHUP);
  const long before = lines_in(read_file(path("s.csv")));
  EXPECT_TRUE(frames_reach(before + 10)) << "it ended: " << err();
  send(SIGTERM);
  EXPECT_EQ(wait(), 0) << err();
  expect_whole_files();
}

TEST_F(CliLiveSignals, RecordLeavesCompleteFiles) {
  for (const int signal : {SIGHUP, SIGTERM}) {
    std::filesystem::remove_all(path("sequence"));
    start("record " + path("sequence"));
    EXPECT_TRUE(comes_true([&] { return lines_in(read_file(path("sequence/depth.txt"))) > 10; })) << err();
    send(signal);
    EXPECT_EQ(wait(), 0) << err();
    expect_whole_recording(lines_in(read_file(path("sequence/rgb.txt"))) - 1);
  }
}

}  // namespace
}  // namespace plvo_test
