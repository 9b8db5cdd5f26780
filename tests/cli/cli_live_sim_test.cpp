// SPDX-License-Identifier: Apache-2.0
// Tests `plvo live` without a sensor: the simulated camera in its place, at its own pace.
#include <gtest/gtest.h>

#include <array>
#include <nlohmann/json.hpp>
#include <sstream>
#include <vector>

#include "plvo/math/se3.hpp"
#include "plvo_command.hpp"

namespace plvo {
namespace {

using test::CommandResult;
using test::read_file;

class CliLiveSim : public test::PlvoCommand {};

const std::string kSimulated = " --camera sim --scene bare --size 160x120 --frames 8";

TEST_F(CliLiveSim, PosesAreThoseOfARun) {
  const CommandResult live = plvo("live --pace fast --out " + path("live.txt") + kSimulated);
  ASSERT_EQ(live.exit_code, 0) << live.err;
  EXPECT_NE(live.err.find("wrote " + path("live.txt")), std::string::npos) << live.err;
  ASSERT_EQ(plvo("run --quiet --out " + path("run.txt") + kSimulated).exit_code, 0);
  EXPECT_EQ(read_file(path("live.txt")), read_file(path("run.txt")));
}

// Eight frames at 4 Hz cannot end before their last stamp, however fast the machine.
TEST_F(CliLiveSim, FramesComeAtTheirOwnPace) {
  const CommandResult live = plvo("live --fps 4 --quiet --json " + path("own.json") + kSimulated);
  ASSERT_EQ(live.exit_code, 0) << live.err;
  const auto own = nlohmann::json::parse(read_file(path("own.json")));
  EXPECT_EQ(own["frames"], 8);
  EXPECT_GE(own["seconds"].get<double>(), 7.0 / 4 - 0.01);
  EXPECT_LT(own["camera_hz"].get<double>(), 4.05);
}

// Also what a map makes of them.
TEST_F(CliLiveSim, TheMapIsThatOfARun) {
  const std::string recording = " --camera sim --scene desk --size 160x120 --frames 150 --map 32";
  const auto files = [this](const std::string& name) {
    return " --map-out " + path(name + ".map") + " --map-trajectory " + path(name + ".txt") + " --ply " +
           path(name + ".ply");
  };
  const CommandResult live = plvo("live --pace fast --json " + path("live.json") + recording + files("live"));
  ASSERT_EQ(live.exit_code, 0) << live.err;
  EXPECT_NE(live.out.find("keyframes of 32"), std::string::npos) << live.out;
  EXPECT_NE(live.err.find(path("live.map") + ", " + path("live.txt") + ", " + path("live.ply")),
            std::string::npos)
      << live.err;
  ASSERT_EQ(plvo("run --quiet --json " + path("run.json") + recording + files("run")).exit_code, 0);
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
      plvo("live --pace fast --map-in " + path("live.map") + " --json " + path("next.json") + recording);
  ASSERT_EQ(next.exit_code, 0) << next.err;
  EXPECT_NE(next.out.find("place in the map       found after"), std::string::npos) << next.out;
  const nlohmann::json next_map = nlohmann::json::parse(read_file(path("next.json"))).at("map");
  EXPECT_EQ(next_map.at("loaded"), live_map.at("keyframes"));
  EXPECT_TRUE(next_map.at("located"));
}

// The pose in the map, by the stream alone.
class CliLiveMapStream : public CliLiveSim {
 protected:
  static std::vector<nlohmann::json> stream_of(const std::string& more) {
    const CommandResult live = plvo("live --pace fast --quiet --stream -" + more);
    EXPECT_EQ(live.exit_code, 0) << live.err;
    std::vector<nlohmann::json> lines;
    std::istringstream text(live.out);
    for (std::string line; std::getline(text, line);)
      if (nlohmann::json json = nlohmann::json::parse(line); json.contains("stamp_ns")) lines.push_back(json);
    return lines;
  }
  static Se3 pose_of(const nlohmann::json& json) {
    const auto t = json["position"].get<std::array<double, 3>>();
    const auto q = json["orientation_xyzw"].get<std::array<double, 4>>();
    return {to_rotation({q[0], q[1], q[2], q[3]}), {t[0], t[1], t[2]}};
  }
};

TEST_F(CliLiveMapStream, TellsWhereTheCameraIsInTheMap) {
  const std::string recording = " --camera sim --scene desk --size 160x120 --frames 150";
  ASSERT_EQ(plvo("run --quiet --map 32" + recording + " --map-out " + path("desk.map")).exit_code, 0);
  const std::string map = " --map 32 --map-in " + path("desk.map");
  const std::string mount = " --base-camera 0.2 0.1 0.5 -0.5 0.5 -0.5 0.5";
  const Se3 T_base_camera = {to_rotation({-0.5, 0.5, -0.5, 0.5}), {0.2, 0.1, 0.5}};
  const auto without = stream_of(recording), of_camera = stream_of(recording + map),
             of_base = stream_of(recording + map + mount);
  ASSERT_EQ(without.size(), 150U);
  ASSERT_EQ(of_camera.size(), 150U);
  ASSERT_EQ(of_base.size(), 150U);
  int located = 0;
  for (std::size_t i = 0; i < 150; ++i) {
    EXPECT_FALSE(without[i].contains("map"));
    nlohmann::json rest = of_camera[i];
    rest.erase("map");
    EXPECT_EQ(rest, without[i]) << "the map changes no other member";
    const nlohmann::json& in_map = of_camera[i]["map"];
    EXPECT_EQ(in_map["located"], of_base[i]["map"]["located"]);
    if (!in_map["located"].get<bool>()) {
      EXPECT_TRUE(in_map["position"].is_null());
      EXPECT_EQ(located, 0) << "it stays located";
      continue;
    }
    ++located;
    // The same sequence again: the map's frame is the world.
    EXPECT_LT(pose_of(in_map).t.norm(), 0.03) << i;
    EXPECT_LT(in_map["covariance"][0].get<double>(), 1e-3);
    const Se3 T_map_camera = pose_of(in_map) * pose_of(of_camera[i]);
    const Se3 T_map_base = pose_of(of_base[i]["map"]) * pose_of(of_base[i]);
    EXPECT_LT(boxminus(T_map_base, T_base_camera * T_map_camera * T_base_camera.inverse()).norm(), 1e-6) << i;
  }
  EXPECT_GT(located, 100);
  EXPECT_GT(of_camera.back()["map"]["loops"], 0);
}

TEST_F(CliLiveSim, WhatDoesNotApplyIsRefused) {
  expect_refused(plvo("live --device recording.bag" + kSimulated), 2,
                 "--device: is for a sensor or a recording");
  expect_refused(plvo("live --mode 320x240" + kSimulated), 2, "--mode: is for a sensor or a recording");
  expect_refused(plvo("live --fx 500 --fy 500" + kSimulated), 2, "is for a sensor or a recording");
  expect_refused(plvo("live --every-frame" + kSimulated), 2,
                 "--every-frame: is what a recording and the simulated");
  expect_refused(plvo("live --record x.oni" + kSimulated), 2, "are kept as a folder, not as an .oni file");
  expect_refused(plvo("live --map-out x.map" + kSimulated), 2, "--map-out: is for a map: add --map N");
  expect_refused(plvo("live --map 8 --map-out " + path("no/x.map") + kSimulated), 1, "cannot create");
  expect_refused(plvo("live --map 8 --map-in " + path("none.map") + kSimulated), 1, "cannot read");
  expect_refused(plvo("live --scene bare"), 2, "--scene: is for the simulated camera: add --camera sim");
  expect_refused(plvo("live --pace fast"), 2, "--pace: is for a recording or the simulated camera");
}

}  // namespace
}  // namespace plvo
