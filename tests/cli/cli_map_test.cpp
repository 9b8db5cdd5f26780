// SPDX-License-Identifier: Apache-2.0
// Tests `plvo run --map`: the map beside the odometry changes none of its results; its files and its summary.
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>

#include "plvo_command.hpp"
#include "simulated_sequence.hpp"

namespace plvo {
namespace {

namespace fs = std::filesystem;
using test::CommandResult;
using test::read_file;

constexpr int kFramesOfMapRun = 6;

class CliMap : public test::PlvoCommand {
 protected:
  CommandResult run(const std::string& more) const {
    return plvo("run " + test::simulated_sequence<kFramesOfMapRun>().string() + ' ' + more);
  }
  std::string file(const char* name) const { return (folder_ / name).string(); }
};

TEST_F(CliMap, ChangesNoResultOfTheOdometry) {
  ASSERT_EQ(run("--out " + file("without.txt")).exit_code, 0);
  const CommandResult with =
      run("--map 8 --out " + file("with.txt") + " --map-trajectory " + file("map.txt"));
  ASSERT_EQ(with.exit_code, 0) << with.err;
  EXPECT_NE(with.out.find("keyframes of 8"), std::string::npos) << with.out;
  EXPECT_NE(with.out.find("ATE in the map"), std::string::npos) << with.out;
  EXPECT_EQ(read_file(file("with.txt")), read_file(file("without.txt")));
  // Nothing was seen again, so the map's trajectory is the odometry's to rounding: the same stamps, and
  // positions within a micrometre.
  std::istringstream odometry(read_file(file("with.txt"))), map(read_file(file("map.txt")));
  std::string line, other;
  int poses = 0;
  while (std::getline(odometry, line) && std::getline(map, other)) {
    if (line.empty() || line[0] == '#') continue;
    std::istringstream a(line), b(other);
    std::string stamp, stamp_in_map;
    ASSERT_TRUE(a >> stamp && b >> stamp_in_map);
    EXPECT_EQ(stamp, stamp_in_map);
    for (int i = 0; i < 7; ++i) {
      double x = 0, y = 0;
      ASSERT_TRUE(a >> x && b >> y);
      EXPECT_NEAR(x, y, 1e-6);
    }
    ++poses;
  }
  EXPECT_EQ(poses, kFramesOfMapRun);
}

TEST_F(CliMap, WritesAPlyWithPointsLinesAndTrajectory) {
  ASSERT_EQ(run("--map 8 --quiet --ply " + file("map.ply")).exit_code, 0);
  std::istringstream ply(read_file(file("map.ply")));
  std::string line;
  std::size_t vertices = 0, edges = 0;
  while (std::getline(ply, line) && line != "end_header") {
    (void)std::sscanf(line.c_str(), "element vertex %zu", &vertices);
    (void)std::sscanf(line.c_str(), "element edge %zu", &edges);
  }
  EXPECT_GT(vertices, 100U);
  EXPECT_GE(edges, kFramesOfMapRun - 1U);
  std::size_t rows = 0;
  double a = 0, b = 0;
  while (std::getline(ply, line)) {
    ++rows;
    if (rows <= vertices) continue;
    ASSERT_EQ(std::sscanf(line.c_str(), "%lf %lf", &a, &b), 2) << line;
    EXPECT_TRUE(a >= 0 && b > a && b < static_cast<double>(vertices)) << line;
  }
  EXPECT_EQ(rows, vertices + edges);
}

TEST_F(CliMap, TheSummaryCountsWhatTheMapDid) {
  ASSERT_EQ(run("--map 64 --quiet --json " + file("run.json")).exit_code, 0);
  const nlohmann::json map = nlohmann::json::parse(read_file(file("run.json"))).at("map");
  EXPECT_EQ(map.at("capacity"), 64);
  EXPECT_GE(map.at("keyframes"), 1);
  EXPECT_EQ(map.at("recognised"), 0);
  EXPECT_LT(map.at("ate_m"), 0.05);
  ASSERT_EQ(run("--quiet --json " + file("none.json")).exit_code, 0);
  EXPECT_FALSE(nlohmann::json::parse(read_file(file("none.json"))).contains("map"));
}

TEST_F(CliMap, RefusesFilesOfAMapWithoutOneAndSizesThatItCannotHave) {
  expect_refused(run("--ply " + file("map.ply")), 2, "add --map N");
  expect_refused(run("--map-trajectory " + file("map.txt")), 2, "add --map N");
  expect_refused(run("--map 7"), 2, "8");
  expect_refused(run("--map 513"), 2, "512");
  EXPECT_EQ(test::run_command("TMPDIR=" + file("none") + " " + test::kPlvo + " run --camera sim --frames 2 " +
                              "--map 8 --map-trajectory " + file("map.txt"))
                .exit_code,
            1);
  expect_refused(run("--map 8 --out " + file("same.txt") + " --map-trajectory " + file("same.txt")), 2,
                 "--map-trajectory");
}

}  // namespace
}  // namespace plvo
