// SPDX-License-Identifier: Apache-2.0
// The difficulties of a simulated sequence, each compared with a plain calculation.
#include <algorithm>
#include <array>
#include <cmath>

#include "plvo/simulator/render/renderer.hpp"
#include "plvo/simulator/scene/things.hpp"
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

// The motion of each part from one moment to another, applied to a corner of each other part.
TEST(Difficulties, NoTwoPartsOfThePersonHaveTheSameMotion) {
  for (const char* name : {"person", "person-ahead"}) {
    const SimulatorOptions options = with({name});
    const std::unique_ptr<sim::Scene> scene = sim::build_scene(options.scene, options.seed);
    const sim::Trajectory trajectory = sim::Trajectory::hand_held(*scene, options.seed, 3.3);
    const sim::Things things(options, trajectory, *scene);
    const auto parts_at = [&](double t_s) {
      things.place(t_s, 0, *scene);
      return std::vector<sim::Solid>(scene->solids.begin() + static_cast<std::ptrdiff_t>(scene->first_thing),
                                     scene->solids.end());
    };
    constexpr int kMoments = 8;
    std::array<std::array<float, 10>, 10> most_m{};
    for (int k = 0; k < kMoments; ++k) {
      const std::vector<sim::Solid> before = parts_at(1 + 0.25 * k);
      const std::vector<sim::Solid> after = parts_at(1.25 + 0.25 * k);
      ASSERT_EQ(before.size(), 10U);
      for (std::size_t i = 0; i < 10; ++i) {
        for (std::size_t j = 0; j < 10; ++j) {
          const sim::Float3 corner = before[j].to_world(before[j].half);
          const sim::Float3 moved = after[i].to_world(before[i].to_local(corner));
          most_m[i][j] = std::max(most_m[i][j], norm(moved - after[j].to_world(after[j].half)));
        }
      }
    }
    for (std::size_t i = 0; i < 10; ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        EXPECT_GT(std::max(most_m[i][j], most_m[j][i]), 0.02F) << name << ": " << i << " and " << j;
      }
    }
  }
}

constexpr double kMirrorPlane_m = 1.99;  // front of the pane

TEST(Difficulties, MirrorHasTheDepthOfItsPlane) {
  const std::vector<Shot> plain = shoot(with({}));
  const std::vector<Shot> shots = shoot(with({"mirror"}));
  Vector3 forward = shots[0].T_world_camera.R.col(2);
  forward.z() = 0;
  forward.normalize();
  for (std::size_t k = 0; k < shots.size(); ++k) {
    const Se3& T = shots[k].T_world_camera;
    const double ahead_m = kMirrorPlane_m - forward.dot(T.t - shots[0].T_world_camera.t);
    int on_pane = 0;
    for (int y = 0; y < 120; ++y) {
      for (int x = 0; x < 160; ++x) {
        const std::size_t i = static_cast<std::size_t>(y * 160 + x);
        if (shots[k].exact[i] == plain[k].exact[i]) continue;
        const Vector3 ray((x - 79.5) / 131.25, (y - 59.5) / 131.25, 1);
        const double expected_m = ahead_m / forward.dot(T.R * ray);
        // The pane's side, a centimetre deep, is seen in a few pixels.
        if (std::abs(static_cast<double>(shots[k].exact[i]) - expected_m) < 1e-4) ++on_pane;
      }
    }
    EXPECT_GT(on_pane, 160 * 120 / 5) << k;
  }
}

// A mirror shows what a camera at the mirrored pose sees, with left and right exchanged.
TEST(Difficulties, MirrorShowsWhatTheMirroredCameraSees) {
  const SimulatorOptions options = with({"mirror"});
  const std::unique_ptr<sim::Scene> scene = sim::build_scene(options.scene, options.seed);
  const sim::Trajectory trajectory = sim::Trajectory::hand_held(*scene, options.seed, 1);
  const sim::Things things(options, trajectory, *scene);
  const Se3 T = trajectory.at(0);
  Vector3 forward = T.R.col(2);
  forward.z() = 0;
  forward.normalize();
  const Matrix3 reflection = Matrix3::Identity() - 2 * forward * forward.transpose();
  Se3 mirrored;
  mirrored.R = reflection * T.R * Vector3(-1, 1, 1).asDiagonal();
  mirrored.t = T.t + 2 * kMirrorPlane_m * forward;
  const auto render = [&](const Se3& T_world_camera) {
    auto renderer = std::make_unique<sim::Renderer>(*scene, options.camera, 1);
    renderer->render(std::vector<Se3>(120, T_world_camera), {});
    return renderer;
  };
  const auto directly = render(mirrored);
  things.place(0, 0, *scene);
  const auto reflected = render(T);
  int on_pane = 0;
  int same = 0;
  for (int y = 0; y < 120; ++y) {
    for (int x = 0; x < 160; ++x) {
      const int solid = reflected->hits().at(x, y).surface / sim::Solid::kFaces;
      if (!scene->is_thing(solid)) continue;
      ++on_pane;
      const float expected = 0.85F * luminance(directly->radiance().at(159 - x, y));
      const float seen = luminance(reflected->radiance().at(x, y));
      same += std::abs(seen - expected) < 0.1F * expected + 0.03F ? 1 : 0;
    }
  }
  EXPECT_GT(on_pane, 160 * 120 / 5);
  EXPECT_GT(same, on_pane * 9 / 10);
}

TEST(Difficulties, WhatTheCameraCarriesStaysAtItsPixels) {
  const std::vector<Shot> plain = shoot(with({}));
  const std::vector<Shot> shots = shoot(with({"bumper", "clock"}));
  for (const Shot& shot : shots) {
    double difference = 0;
    for (std::size_t i = 102 * 160; i < shot.exact.size(); ++i) {
      ASSERT_EQ(shot.exact[i], 0.55F);
      difference += std::abs(shot.gray(i) - shots[0].gray(i));
    }
    EXPECT_LT(difference / (18 * 160), 4) << "exposure changes a little";
    EXPECT_EQ(shot.colour[0], 0);
    EXPECT_EQ(shot.colour[3 * (160 + 1)], 255);  // the first digit is 0
  }
  const std::vector<Shot> dotted = shoot(with({"dots"}));
  for (std::size_t k = 0; k < dotted.size(); ++k) {
    EXPECT_EQ(dotted[k].exact, plain[k].exact);
    int brighter = 0;
    for (std::size_t i = 0; i < plain[0].exact.size(); ++i) {
      if (plain[0].gray(i) > 240 || plain[k].gray(i) > 240) continue;
      const bool dot = dotted[k].gray(i) > plain[k].gray(i);
      EXPECT_EQ(dot, dotted[0].gray(i) > plain[0].gray(i)) << i;
      brighter += dot ? 1 : 0;
    }
    EXPECT_GT(brighter, 160 * 120 / 20);
    EXPECT_LT(brighter, 160 * 120 / 5);
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

TEST(Difficulties, NamesAreThoseOfTheList) {
  Difficulties difficulties;
  EXPECT_EQ(add_difficulty("moon", difficulties).code(), StatusCode::kInvalidArgument);
  for (const std::string& name : difficulty_names()) {
    EXPECT_TRUE(add_difficulty(name, difficulties).ok()) << name;
    EXPECT_TRUE(difficulties.validate().ok()) << name;
  }
}

}  // namespace
}  // namespace plvo
