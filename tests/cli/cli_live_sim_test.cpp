// SPDX-License-Identifier: Apache-2.0
// Tests `plvo live` without a sensor: the simulated camera in its place, at its own pace.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "plvo_command.hpp"

namespace plvo {
namespace {

using test::CommandResult;
using test::read_file;

class CliLiveSim : public test::PlvoCommand {};

const std::string kWalk = " --camera sim --scene bare --size 160x120 --frames 8";

TEST_F(CliLiveSim, PosesAreThoseOfARun) {
  const CommandResult live = plvo("live --pace fast --out " + path("live.txt") + kWalk);
  ASSERT_EQ(live.exit_code, 0) << live.err;
  EXPECT_NE(live.err.find("wrote " + path("live.txt")), std::string::npos) << live.err;
  ASSERT_EQ(plvo("run --quiet --out " + path("run.txt") + kWalk).exit_code, 0);
  EXPECT_EQ(read_file(path("live.txt")), read_file(path("run.txt")));
}

// Eight frames at 4 Hz cannot end before their last stamp, however fast the machine.
TEST_F(CliLiveSim, FramesComeAtTheirOwnPace) {
  const CommandResult live = plvo("live --fps 4 --quiet --json " + path("own.json") + kWalk);
  ASSERT_EQ(live.exit_code, 0) << live.err;
  const auto own = nlohmann::json::parse(read_file(path("own.json")));
  EXPECT_EQ(own["frames"], 8);
  EXPECT_GE(own["seconds"].get<double>(), 7.0 / 4 - 0.01);
  EXPECT_LT(own["camera_hz"].get<double>(), 4.05);
}

// Also what a map makes of them.
TEST_F(CliLiveSim, TheMapIsThatOfARun) {
  const std::string walk = " --camera sim --scene desk --size 160x120 --frames 150 --map 32";
  const auto files = [this](const std::string& name) {
    return " --map-out " + path(name + ".map") + " --map-trajectory " + path(name + ".txt") + " --ply " +
           path(name + ".ply");
  };
  const CommandResult live = plvo("live --pace fast --json " + path("live.json") + walk + files("live"));
  ASSERT_EQ(live.exit_code, 0) << live.err;
  EXPECT_NE(live.out.find("keyframes of 32"), std::string::npos) << live.out;
  EXPECT_NE(live.err.find(path("live.map") + ", " + path("live.txt") + ", " + path("live.ply")),
            std::string::npos)
      << live.err;
  ASSERT_EQ(plvo("run --quiet --json " + path("run.json") + walk + files("run")).exit_code, 0);
  for (const char* end : {".map", ".txt", ".ply"}) {
    EXPECT_GT(read_file(path(std::string("live") + end)).size(), 1000U) << end;
    EXPECT_TRUE(read_file(path(std::string("live") + end)) == read_file(path(std::string("run") + end)))
        << end;
  }
  const nlohmann::json live_map = nlohmann::json::parse(read_file(path("live.json"))).at("map");
  const nlohmann::json run_map = nlohmann::json::parse(read_file(path("run.json"))).at("map");
  EXPECT_EQ(live_map.at("keyframes"), run_map.at("keyframes"));
  EXPECT_EQ(live_map.at("capacity"), 32);
  EXPECT_TRUE(live_map.at("ate_m").is_null());

  // The next day begins with it.
  const CommandResult next =
      plvo("live --pace fast --map-in " + path("live.map") + " --json " + path("next.json") + walk);
  ASSERT_EQ(next.exit_code, 0) << next.err;
  EXPECT_NE(next.out.find("place in the map       found after"), std::string::npos) << next.out;
  const nlohmann::json next_map = nlohmann::json::parse(read_file(path("next.json"))).at("map");
  EXPECT_EQ(next_map.at("loaded"), live_map.at("keyframes"));
  EXPECT_TRUE(next_map.at("located"));
}

TEST_F(CliLiveSim, WhatDoesNotApplyIsRefused) {
  expect_refused(plvo("live --device walk.bag" + kWalk), 2, "--device: is for a sensor or a recording");
  expect_refused(plvo("live --mode 320x240" + kWalk), 2, "--mode: is for a sensor or a recording");
  expect_refused(plvo("live --fx 500 --fy 500" + kWalk), 2, "is for a sensor or a recording");
  expect_refused(plvo("live --every-frame" + kWalk), 2,
                 "--every-frame: is what a recording and the simulated");
  expect_refused(plvo("live --record x.oni" + kWalk), 2, "are kept as a folder, not as an .oni file");
  expect_refused(plvo("live --map-out x.map" + kWalk), 2, "--map-out: is for a map: add --map N");
  expect_refused(plvo("live --map 8 --map-out " + path("no/x.map") + kWalk), 1, "cannot create");
  expect_refused(plvo("live --map 8 --map-in " + path("none.map") + kWalk), 1, "cannot read");
  expect_refused(plvo("live --scene bare"), 2, "--scene: is for the simulated camera: add --camera sim");
  expect_refused(plvo("live --pace fast"), 2, "--pace: is for a recording or the simulated camera");
}

}  // namespace
}  // namespace plvo
