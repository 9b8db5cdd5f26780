// SPDX-License-Identifier: Apache-2.0
// The mask of the camera's image: what lies in masked pixels has no influence, no feature lies there, and a
// part of the robot in view does no harm.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

#include "plvo/base/random.hpp"
#include "plvo/math/trigonometry.hpp"
#include "plvo/odometry/odometry.hpp"
#include "procedural_sequence.hpp"
#include "result_fingerprint.hpp"
#include "says.hpp"
#include "sound.hpp"

namespace plvo {
namespace {

constexpr int kWide = 320;
constexpr int kHigh = 240;
constexpr int kBumperTop = kHigh * 17 / 20;  // the lowest 15 %

// A bumper, a clock in a corner and a small mark.
bool is_masked(int x, int y) {
  return y >= kBumperTop || (x >= 230 && x < 300 && y >= 20 && y < 34) ||
         (x >= 90 && x < 96 && y >= 100 && y < 130);
}
std::vector<std::uint8_t> used_pixels() {
  std::vector<std::uint8_t> used(kWide * kHigh);
  for (int i = 0; i < kWide * kHigh; ++i)
    used[static_cast<std::size_t>(i)] = is_masked(i % kWide, i / kWide) ? 0 : 255;
  return used;
}

enum class Content { kRoom, kNoise, kPart };

// A sequence of the procedural room, with something else in the masked pixels.
class MaskedSequence {
 public:
  explicit MaskedSequence(Config config = {}, Limits limits = {kWide, kHigh}, bool with_mask = true) {
    limits.mask = with_mask;
    memory_.resize(required_bytes(limits));
    if (with_mask) config.mask = {used_.data(), kWide, kHigh, kWide};
    const Status status = odometry.init(memory_, sequence_.camera(), config, limits);
    EXPECT_TRUE(status.ok()) << status.message();
  }

  RgbdFrame render(int i, Content content) {
    RgbdFrame frame = sequence_.render(i);
    if (content == Content::kPart && part_depth_.empty()) {  // what the first view shows stays there
      part_colour_.assign(frame.colour.data, frame.colour.data + frame.colour.stride_bytes * kHigh);
      part_depth_.assign(frame.depth.data, frame.depth.data + frame.depth.stride * kHigh);
    }
    colour_.assign(frame.colour.data, frame.colour.data + frame.colour.stride_bytes * kHigh);
    depth_.assign(frame.depth.data, frame.depth.data + frame.depth.stride * kHigh);
    for (int y = 0; y < kHigh && content != Content::kRoom; ++y)
      for (int x = 0; x < kWide; ++x) {
        if (!is_masked(x, y)) continue;
        const auto at = static_cast<std::size_t>(y * frame.depth.stride + x);
        depth_[at] =
            content == Content::kPart ? part_depth_[at] : static_cast<std::uint16_t>(random_.below(65536));
        for (int c = 0; c < 3; ++c) {
          const auto byte = static_cast<std::size_t>(y * frame.colour.stride_bytes + 3 * x + c);
          colour_[byte] =
              content == Content::kPart ? part_colour_[byte] : static_cast<std::uint8_t>(random_.below(256));
        }
      }
    frame.colour.data = colour_.data();
    frame.depth.data = depth_.data();
    return frame;
  }

  TrackResult see(int i, Content content) {
    const TrackResult result = odometry.track(render(i, content));
    EXPECT_TRUE(test::is_sound(result)) << result.status.message();
    return result;
  }

  const CameraModel& camera() const { return sequence_.camera(); }
  Odometry odometry;

 private:
  std::vector<std::uint8_t> used_ = used_pixels();
  std::vector<std::byte> memory_;
  ProceduralSequence sequence_{kWide, kHigh};
  std::vector<std::uint8_t> colour_, part_colour_;
  std::vector<std::uint16_t> depth_, part_depth_;
  Random random_;
};

// The undistorted pixels that may show masked ones.
class MaskedPixels {
 public:
  explicit MaskedPixels(const CameraModel& camera) : memory_(kWide * kHigh + 4096), masked_(kWide * kHigh) {
    Arena arena(memory_);
    UndistortionMap map;
    map.allocate(arena, kWide, kHigh);
    map.init(camera);
    std::vector<std::uint8_t> raw(masked_.size());
    for (int i = 0; i < kWide * kHigh; ++i)
      raw[static_cast<std::size_t>(i)] = is_masked(i % kWide, i / kWide) ? 255 : 0;
    if (map.active())
      map.undistort({raw.data(), kWide, kHigh, kWide}, {masked_.data(), kWide, kHigh, kWide});
    else
      masked_ = raw;
  }
  bool within(double u, double v, int reach) const {
    const int x = static_cast<int>(u + 0.5), y = static_cast<int>(v + 0.5);
    for (int j = std::max(y - reach, 0); j <= std::min(y + reach, kHigh - 1); ++j)
      for (int i = std::max(x - reach, 0); i <= std::min(x + reach, kWide - 1); ++i)
        if (masked_[static_cast<std::size_t>(j * kWide + i)] != 0) return true;
    return false;
  }

 private:
  std::vector<std::byte> memory_;
  std::vector<std::uint8_t> masked_;
};

Config with_policy(ReferencePolicy policy) {
  Config config;
  config.references.policy = policy;
  return config;
}
Config with_features(Features features) {
  Config config;
  config.features = features;
  return config;
}

struct Setting {
  const char* name;
  Config config;
  Limits limits = {kWide, kHigh};
};

std::vector<Setting> all_settings() {
  Limits window{kWide, kHigh};
  window.references = 3;
  Limits tiny = Limits::tiny();
  return {{"default", {}},
          {"points", with_features(Features::kPoints)},
          {"lines", with_features(Features::kLines)},
          {"window", with_policy(ReferencePolicy::kWindow), window},
          {"paper", Config::paper()},
          {"tiny", Config::tiny(), tiny}};
}

std::uint64_t print_of(const TrackResult& result, const FeatureView& view) {
  Fingerprint print = fingerprint_of(result);
  for (const Keypoint& keypoint : view.keypoints) {
    print.add(static_cast<double>(keypoint.u));
    print.add(static_cast<double>(keypoint.v));
  }
  for (const SegmentView& segment : view.segments) print.add(static_cast<double>(segment.a_u));
  for (const PointTrackView& track : view.point_tracks) print.add(static_cast<double>(track.u));
  for (int y = 0; y < view.image.height; ++y)
    for (int x = 0; x < view.image.width; ++x) print.add_byte(view.image.at(x, y));
  return print.value();
}

TEST(Mask, WhatLiesInMaskedPixelsHasNoInfluence) {
  for (const Setting& setting : all_settings()) {
    MaskedSequence room(setting.config, setting.limits), noise(setting.config, setting.limits);
    int tracked = 0;
    for (int i = 0; i < 10; ++i) {
      const TrackResult a = room.see(i, Content::kRoom);
      const TrackResult b = noise.see(i, Content::kNoise);
      tracked += a.state == TrackState::kTracking ? 1 : 0;
      ASSERT_EQ(print_of(a, room.odometry.features()), print_of(b, noise.odometry.features()))
          << setting.name << ", frame " << i;
    }
    EXPECT_EQ(tracked, 9) << setting.name;
  }
}

TEST(Mask, WorkInTwoHalvesGivesTheSameBits) {
  Config config;
  config.executor.run = [](void*, Task here, Task beside) {
    beside();
    here();
  };
  Limits limits{kWide, kHigh};
  limits.cores = 2;
  MaskedSequence one, two(config, limits);
  for (int i = 0; i < 5; ++i)
    EXPECT_EQ(fingerprint(one.see(i, Content::kRoom)), fingerprint(two.see(i, Content::kNoise))) << i;
}

TEST(Mask, NoFeatureAndNoMatchLiesInMaskedPixels) {
  for (const Setting& setting : all_settings()) {
    MaskedSequence masked_sequence(setting.config, setting.limits);
    const MaskedPixels masked(masked_sequence.camera());
    int keypoints = 0, segments = 0, tracks = 0;
    for (int i = 0; i < 10; ++i) {
      (void)masked_sequence.see(i, Content::kPart);
      const FeatureView view = masked_sequence.odometry.features();
      for (const Keypoint& k : view.keypoints) {
        ++keypoints;
        EXPECT_FALSE(
            masked.within(static_cast<double>(k.u), static_cast<double>(k.v), kPatchRadius << k.level));
      }
      for (const SegmentView& s : view.segments) {
        ++segments;
        constexpr int kSteps = 50;
        for (int step = 0; step <= kSteps; ++step) {
          const double along = static_cast<double>(step) / kSteps;
          EXPECT_FALSE(masked.within(static_cast<double>(s.a_u) + along * static_cast<double>(s.b_u - s.a_u),
                                     static_cast<double>(s.a_v) + along * static_cast<double>(s.b_v - s.a_v),
                                     3));
        }
      }
      for (const PointTrackView& t : view.point_tracks) {
        ++tracks;
        EXPECT_FALSE(masked.within(static_cast<double>(t.u), static_cast<double>(t.v), kWindowReach));
      }
    }
    EXPECT_TRUE(keypoints > 150 || setting.config.features == Features::kLines) << setting.name << keypoints;
    EXPECT_TRUE(tracks > 300 || setting.config.features == Features::kLines) << setting.name << tracks;
    EXPECT_TRUE(segments > 100 || setting.config.features == Features::kPoints) << setting.name << segments;
  }
}

TEST(Mask, NoSurfaceSampleLiesInMaskedPixels) {
  const Limits limits = [] {
    Limits all{kWide, kHigh};
    all.mask = true;
    return all;
  }();
  FeatureExtraction extraction;
  FrameFeatures features;
  Arena sizer = Arena::counting();
  extraction.allocate(sizer, limits);
  features.allocate(sizer, limits);
  FeatureExtraction::reserve(sizer, limits);
  std::vector<std::byte> memory(sizer.peak() + kArenaAlignment);
  Arena arena(memory);
  extraction.allocate(arena, limits);
  features.allocate(arena, limits);
  arena.seal();
  ProceduralSequence sequence(kWide, kHigh);
  const CameraModel& camera = sequence.camera();
  const std::vector<std::uint8_t> used = used_pixels();
  extraction.init(camera, {used.data(), kWide, kHigh, kWide});
  const Config config;
  const NoiseScales noise = initial_scales(config.noise);
  StageTimes times{};
  CarriedCells carried;
  const StageContext context{camera, config, noise, arena, times, carried, nullptr};
  const MaskedPixels masked(camera);
  std::size_t samples = 0;
  for (int i = 0; i < 4; ++i) {
    extraction.lift(context, extraction.depth_sampler(sequence.render(i), config.depth_noise), features);
    for (const SurfaceSample& sample : features.surfaces.samples) {
      ++samples;
      const Vector2 at = project(camera.pinhole, sample.p);
      EXPECT_FALSE(masked.within(at.x(), at.y(), 0)) << at.transpose();
    }
  }
  EXPECT_GT(samples, 100U);
}

// Without a mask, the part of the robot is the scene that stands still.
TEST(Mask, APartOfTheRobotInViewDoesNoHarm) {
  const auto worst_error_m = [](bool with_mask, Content content) {
    MaskedSequence masked_sequence({}, {kWide, kHigh}, with_mask);
    double worst = 0;
    for (int i = 0; i < 30; ++i) {
      const TrackResult result = masked_sequence.see(i, content);
      const Se3 truth =
          ProceduralSequence::T_world_camera(0).inverse() * ProceduralSequence::T_world_camera(i);
      worst = std::max(worst, static_cast<double>((result.T_world_camera.t - truth.t).norm()));
      if (with_mask && i > 0) {
        EXPECT_EQ(result.state, TrackState::kTracking) << i;
      }
    }
    return worst;
  };
  const double alone = worst_error_m(true, Content::kRoom);
  const double masked = worst_error_m(true, Content::kPart);
  std::printf("largest error with a part of the robot in view: %.1f mm, without the mask %.1f mm\n",
              1e3 * masked, 1e3 * worst_error_m(false, Content::kPart));
  EXPECT_EQ(alone, masked);
  EXPECT_LT(masked, 0.02);
}

TEST(Mask, AWhiteMaskGivesTheBitsOfNoMask) {
  const std::vector<std::uint8_t> white(kWide * kHigh, 1);
  Limits limits{kWide, kHigh};
  MaskedSequence without({}, limits, false);
  limits.mask = true;
  Config config;
  config.mask = {white.data(), kWide, kHigh, kWide};
  std::vector<std::byte> memory(required_bytes(limits));
  Odometry odometry;
  ASSERT_TRUE(odometry.init(memory, without.camera(), config, limits).ok());
  for (int i = 0; i < 6; ++i) {
    const TrackResult expected = without.see(i, Content::kRoom);
    EXPECT_EQ(fingerprint(odometry.track(without.render(i, Content::kRoom))), fingerprint(expected)) << i;
  }
}

// The sensor delivers an image again, but its clock goes on.
TEST(Mask, RepeatedImagesAreFoundBehindABurntInClock) {
  MaskedSequence masked_sequence;
  for (int i = 0; i < 4; ++i) EXPECT_FALSE(masked_sequence.see(i, Content::kNoise).repeated);
  RgbdFrame again = masked_sequence.render(3, Content::kNoise);
  again.stamp_ns += 10'000'000;
  EXPECT_TRUE(masked_sequence.odometry.track(again).repeated);
}

TEST(Mask, RefusesInvalidMasks) {
  const std::vector<std::uint8_t> pixels(kWide * kHigh, 255), black(kWide * kHigh, 0);
  const CameraModel camera = ProceduralSequence(kWide, kHigh).camera();
  const auto init_with = [&](const GrayView& mask, bool room = true) {
    Limits limits{kWide, kHigh};
    limits.mask = room;
    std::vector<std::byte> memory(required_bytes(limits));
    Config config;
    config.mask = mask;
    Odometry odometry;
    const Status status = odometry.init(memory, camera, config, limits);
    EXPECT_TRUE(status.ok() || status.code() == StatusCode::kInvalidArgument);
    return status;
  };
  EXPECT_TRUE(init_with({pixels.data(), kWide, kHigh, kWide}).ok());
  EXPECT_TRUE(
      test::says(init_with({pixels.data(), kWide, kHigh, kWide}, false), "mask needs Limits::mask = true"));
  EXPECT_TRUE(test::says(init_with({pixels.data(), kHigh, kWide, kHigh}),
                         "must have the size of the camera's images, 320x240, not 240x320"));
  EXPECT_TRUE(test::says(init_with({pixels.data(), kWide, kHigh, kWide - 1}), "stride of mask is shorter"));
  EXPECT_TRUE(test::says(init_with({black.data(), kWide, kHigh, kWide}), "leaves no pixel to be used"));
}

TEST(Mask, TakesMemoryOnlyWhereLimitsAskForIt) {
  Limits with = Limits::vga();
  with.mask = true;
  const std::size_t more = required_bytes(with) - required_bytes(Limits::vga());
  const std::size_t pixels = 640 * 480;
  EXPECT_GE(more, pixels * 33 / 16);
  EXPECT_LE(more, pixels * 33 / 16 + 2 * kArenaAlignment);
}

}  // namespace
}  // namespace plvo
