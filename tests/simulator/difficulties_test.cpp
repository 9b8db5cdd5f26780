// SPDX-License-Identifier: Apache-2.0
// The difficulties of a simulated sequence, each compared with a plain calculation.
#include "plvo/simulator/hard_cases.hpp"
#include "simulator_support.hpp"

namespace plvo {
namespace {

using test::shoot;
using test::Shot;
using test::small_options;

SimulatorOptions with(std::initializer_list<const char*> names) {
  SimulatorOptions options = small_options(SceneName::kCorridor);
  options.noise = false;
  for (const char* name : names) EXPECT_TRUE(add_difficulty(name, options.difficulties).ok()) << name;
  return options;
}

TEST(Difficulties, BoardCoversTheColumnsOfItsProjection) {
  SimulatorOptions options = with({"board"});
  options.still = true;
  options.frames = 3;
  options.difficulties.board->from_s = 0;
  options.difficulties.board->share = 0.45;
  const std::vector<Shot> shots = shoot(options);
  ASSERT_EQ(shots.size(), 3U);
  for (std::size_t k = 0; k < shots.size(); ++k) {
    EXPECT_EQ(shots[k].T_world_camera.t, shots[0].T_world_camera.t);
    // The board is upright and the camera is tilted, so its middle row is compared.
    const double shift_px = 131.25 * 0.4 * static_cast<double>(k) / 30;
    int first = 160;
    int last = -1;
    for (int x = 0; x < 160; ++x) {
      if (std::abs(shots[k].exact[static_cast<std::size_t>(60 * 160 + x)] - 1.0F) > 0.1F) continue;
      first = std::min(first, x);
      last = x;
    }
    EXPECT_NEAR(first, shift_px, 4) << k;
    EXPECT_NEAR(last, 0.45 * 160 + shift_px, 4) << k;
  }
}

TEST(Difficulties, MirrorHasTheDepthOfItsPlane) {
  const std::vector<Shot> plain = shoot(with({}));
  const std::vector<Shot> shots = shoot(with({"mirror"}));
  const std::size_t pixel = 60 * 160 + 45;
  EXPECT_NEAR(shots[0].exact[pixel], 2.0F, 0.15F);
  EXPECT_NE(shots[0].colour, plain[0].colour);
}

TEST(Difficulties, BumperAndClockStayAtTheirPixels) {
  const std::vector<Shot> shots = shoot(with({"bumper", "clock"}));
  for (const Shot& shot : shots) {
    for (std::size_t i = 102 * 160; i < shot.exact.size(); ++i) ASSERT_EQ(shot.exact[i], 0.55F);
    EXPECT_EQ(shot.colour[0], 0);
    EXPECT_EQ(shot.colour[3 * (160 + 1)], 255);  // the first digit is 0
  }
}

TEST(Difficulties, FaultsOfTheSensor) {
  SimulatorOptions options = with({"comb", "repeated-frames"});
  std::vector<Shot> shots = shoot(options);
  for (std::size_t i = 0; i < shots[0].depth.size(); ++i) {
    const bool empty = i % 160 % 2 == 0 || i / 160 % 2 == 0;
    ASSERT_EQ(shots[0].depth[i] == 0, empty || shots[0].exact[i] > 13.1F) << i;
  }
  EXPECT_EQ(shots[0].colour, shots[1].colour);
  EXPECT_EQ(shots[2].depth, shots[3].depth);
  EXPECT_NE(shots[1].colour, shots[2].colour);
  options = with({});
  options.difficulties.frozen_depth = 1;
  shots = shoot(options);
  EXPECT_NE(shots[0].depth, shots[1].depth);
  EXPECT_EQ(shots[1].depth, shots[3].depth);
}

TEST(Difficulties, SameBitsWhateverTheThreadsAndTheSameTruth) {
  SimulatorOptions options = with({"board", "person", "mirror", "bumper", "dots", "clock"});
  options.noise = true;
  options.difficulties.board->from_s = options.difficulties.person->from_s = 0;
  options.threads = 1;
  const std::vector<Shot> one = shoot(options);
  options.threads = 3;
  const std::vector<Shot> three = shoot(options);
  const std::vector<Shot> plain = shoot(with({}));
  for (std::size_t k = 0; k < one.size(); ++k) {
    EXPECT_EQ(one[k].colour, three[k].colour);
    EXPECT_EQ(one[k].depth, three[k].depth);
    EXPECT_EQ(one[k].T_world_camera.t, plain[k].T_world_camera.t);
  }
}

TEST(Difficulties, NamesAndCasesAreValid) {
  Difficulties difficulties;
  EXPECT_EQ(add_difficulty("moon", difficulties).code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(hard_cases().size(), 10U);
  for (const HardCase& hard : hard_cases()) EXPECT_TRUE(hard.options.validate().ok()) << hard.name;
}

}  // namespace
}  // namespace plvo
