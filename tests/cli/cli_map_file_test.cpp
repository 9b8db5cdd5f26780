// SPDX-License-Identifier: Apache-2.0
// Tests maps in files: `plvo run --map-out` and `--map-in`, and `plvo map`. A second session begins
// elsewhere, under other light, and finds its place in the map of the first.
#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "plvo/math/se3.hpp"
#include "plvo_command.hpp"
#include "simulated_sequence.hpp"

namespace plvo {
namespace {

namespace fs = std::filesystem;
using test::CommandResult;
using test::read_file;

// By stamp, as it is written.
std::map<std::string, Se3> poses_of(const std::string& file) {
  std::map<std::string, Se3> poses;
  std::istringstream lines(read_file(file));
  for (std::string line; std::getline(lines, line);) {
    std::istringstream numbers(line);
    std::string stamp;
    Se3 T;
    Quaternion q;
    if (line[0] == '#' || !(numbers >> stamp >> T.t.x() >> T.t.y() >> T.t.z() >> q.x >> q.y >> q.z >> q.w))
      continue;
    T.R = to_rotation(q);
    poses[stamp.substr(0, stamp.find('.') + 7)] = T;
  }
  return poses;
}

class CliMapFile : public test::PlvoCommand {
 protected:
  static constexpr int kFramesInRoom = 200;

  // One sequence past a desk, under constant light and under a lamp that swings.
  static std::string desk(const std::string& light) {
    static const test::TemporaryFolder folder;
    const fs::path sequence = folder / light;
    if (!fs::exists(sequence)) {
      const CommandResult made =
          plvo("simulate --scene desk --size 160x120 --quiet --frames " + std::to_string(kFramesInRoom) +
               " --light " + light + " --out " + sequence.string());
      EXPECT_EQ(made.exit_code, 0) << made.err;
    }
    return sequence.string();
  }
  CommandResult first_session(const std::string& more) const {
    return plvo("run " + desk("constant") + " --frames 0:150 --map 64 --quiet " + more);
  }
  CommandResult second_session(const std::string& more) const {
    return plvo("run " + desk("varying") + " --frames 90:200 --map 64 " + more);
  }
  nlohmann::json read_json(const char* name) const { return nlohmann::json::parse(read_file(path(name))); }
};

TEST_F(CliMapFile, TheSecondSessionFindsItsPlaceInTheMapOfTheFirst) {
  ASSERT_EQ(first_session("--map-out " + path("desk.map")).exit_code, 0);
  EXPECT_FALSE(fs::exists(path("desk.map.part")));
  ASSERT_EQ(plvo("map " + path("desk.map") + " --json " + path("before.json")).exit_code, 0);
  // The new map may take the place of the old one.
  const CommandResult second =
      second_session("--map-in " + path("desk.map") + " --map-out " + path("desk.map") +
                     " --map-trajectory " + path("map.txt") + " --json " + path("run.json"));
  ASSERT_EQ(second.exit_code, 0) << second.err;
  EXPECT_NE(second.out.find("place in the map       found after"), std::string::npos) << second.out;
  EXPECT_NE(second.err.find("wrote " + path("run.json") + ", " + path("desk.map") + ", " + path("map.txt")),
            std::string::npos)
      << second.err;
  const nlohmann::json summary = read_json("run.json").at("map");
  EXPECT_TRUE(summary.at("located"));
  EXPECT_LE(summary.at("located_after_s"), 1.0);
  EXPECT_EQ(summary.at("loaded"), read_json("before.json").at("keyframes"));

  // The frame of the map is the camera at the first frame of the first session.
  const std::map<std::string, Se3> truth = poses_of(desk("varying") + "/groundtruth.txt");
  const std::map<std::string, Se3> poses = poses_of(path("map.txt"));
  ASSERT_EQ(poses.size(), 110U);
  double worst = 0;
  for (const auto& [stamp, T] : poses) {
    ASSERT_EQ(truth.count(stamp), 1U) << stamp;
    worst = std::max(worst, (T.t - (truth.begin()->second.inverse() * truth.at(stamp)).t).norm());
  }
  std::printf("farthest from the truth: %.1f mm; found after %.2f s\n", 1e3 * worst,
              summary.at("located_after_s").get<double>());
  EXPECT_LT(worst, 0.05);

  const CommandResult page = plvo("map " + path("desk.map") + " --json " + path("after.json"));
  ASSERT_EQ(page.exit_code, 0) << page.err;
  EXPECT_NE(page.out.find("extent of the trajectory"), std::string::npos) << page.out;
  const nlohmann::json after = read_json("after.json");
  EXPECT_EQ(after.at("keyframes"), summary.at("keyframes"));
  EXPECT_EQ(after.at("placed_keyframes"), after.at("keyframes"));
  EXPECT_EQ(after.at("bytes"), fs::file_size(path("desk.map")));
  EXPECT_EQ(after.at("camera").at("width"), 160);
  EXPECT_GT(after.at("loops"), 0);
}

TEST_F(CliMapFile, InAnotherRoomThePlaceIsNotKnown) {
  ASSERT_EQ(first_session("--map-out " + path("desk.map")).exit_code, 0);
  const CommandResult other = plvo("run " + test::simulated_sequence<60>().string() + " --map 64 --map-in " +
                                   path("desk.map") + " --map-out " + path("both.map") +
                                   " --map-trajectory " + path("map.txt") + " --json " + path("run.json"));
  ASSERT_EQ(other.exit_code, 0) << other.err;
  EXPECT_NE(other.out.find("not known: no place of the loaded map was recognised"), std::string::npos)
      << other.out;
  EXPECT_FALSE(read_json("run.json").at("map").at("located"));
  EXPECT_TRUE(read_json("run.json").at("map").at("located_after_s").is_null());
  EXPECT_TRUE(poses_of(path("map.txt")).empty()) << "frames whose place is not known have no pose in the map";
  const CommandResult page = plvo("map " + path("both.map"));
  EXPECT_NE(page.out.find("is not known"), std::string::npos) << page.out;
}

TEST_F(CliMapFile, ThreeWaysOutAreTheSameBytesAndALinkStaysOne) {
  fs::create_symlink(path("desk.map"), path("link.map"));
  ASSERT_EQ(first_session("--map-out " + path("link.map")).exit_code, 0);
  EXPECT_TRUE(fs::is_symlink(path("link.map")));
  const std::string bytes = read_file(path("desk.map"));
  EXPECT_EQ(bytes.substr(0, 8), "plvo map");
  EXPECT_TRUE(first_session("--map-out -").out == bytes);
  EXPECT_EQ(first_session("--map-out /dev/null").exit_code, 0);
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
}

TEST_F(CliMapFile, AnOlderMapStaysWhereNoneCanBeSaved) {
  test::write_file(path("old.map"), "an older map");
  expect_refused(first_session("--features lines --map-out " + path("old.map")), 1,
                 "the map holds no keyframe yet");
  EXPECT_EQ(read_file(path("old.map")), "an older map");
  EXPECT_FALSE(fs::exists(path("old.map.part")));
  expect_refused(first_session("--map-out " + path("no/folder.map")), 1, "cannot create");
}

TEST_F(CliMapFile, RefusesFilesThatItCannotUse) {
  ASSERT_EQ(plvo("run " + desk("varying") + " --map 64 --quiet --map-out " + path("desk.map")).exit_code, 0);
  const std::string bytes = read_file(path("desk.map"));
  const auto refuse = [this](const std::string& file, const std::string& words) {
    expect_refused(second_session("--map-in " + file), 1, words);
    expect_refused(plvo("map " + file), 1, words);
  };
  refuse(path("none.map"), "cannot read");
  test::write_file(path("text.map"), "no map");
  refuse(path("text.map"), "text.map: this is not a map that plvo saved");
  test::write_file(path("cut.map"), bytes.substr(0, bytes.size() / 2));
  refuse(path("cut.map"), "the map is cut off");
  test::write_file(path("long.map"), bytes + "x");
  refuse(path("long.map"), "1 bytes follow the end of the map");
  std::string flipped = bytes;
  flipped[bytes.size() / 2] = static_cast<char>(flipped[bytes.size() / 2] ^ 1);
  test::write_file(path("flipped.map"), flipped);
  refuse(path("flipped.map"), "the map is damaged");
  expect_refused(second_session("--fx 130 --fy 131 --cx 80 --cy 60 --map-in " + path("desk.map")), 1,
                 "made with another camera");
  expect_refused(plvo("run " + desk("varying") + " --map 8 --map-in " + path("desk.map")), 1,
                 "the map needs room for");
  expect_refused(plvo("run " + desk("varying") + " --map-in " + path("desk.map")), 2, "add --map N");
  expect_refused(plvo("run " + desk("varying") + " --map 64 --map-in " + path("desk.map") + " --out " +
                      path("desk.map")),
                 2, "--out");
}

}  // namespace
}  // namespace plvo
