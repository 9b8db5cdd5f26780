// SPDX-License-Identifier: Apache-2.0
// Two threads: both tasks are done, each on its own thread; and an odometry that has them gives the bits of
// one that has not, over frames that are found, lost and found again, without allocating.
#include "plvo/host/thread_pair.hpp"

#include <gtest/gtest.h>

#include <thread>
#include <vector>

#include "allocation_guard.hpp"
#include "plvo/odometry/odometry.hpp"
#include "procedural_sequence.hpp"
#include "result_fingerprint.hpp"
#include "says.hpp"

namespace plvo {
namespace {

TEST(ThreadPair, RunsEachTaskOnAThreadOfItsOwn) {
  ThreadPair pair;
  const Executor executor = pair.executor();
  const std::thread::id caller = std::this_thread::get_id();
  std::thread::id second;
  for (int i = 0; i < 1000; ++i) {
    int here = 0, beside = 0;
    executor.both(
        [&] {
          EXPECT_EQ(std::this_thread::get_id(), caller);
          here = i + 1;
        },
        [&] {
          const std::thread::id now = std::this_thread::get_id();
          EXPECT_NE(now, caller);
          if (i == 0) second = now;
          EXPECT_EQ(now, second);
          beside = i + 2;
        });
    ASSERT_EQ(here, i + 1);
    ASSERT_EQ(beside, i + 2);
  }
  EXPECT_GT(pair.cpu_ns(), 0);
}

TEST(ThreadPair, HalvesCoverTheRangeOnce) {
  ThreadPair pair;
  for (const Executor& executor : {pair.executor(), Executor()}) {
    for (const std::size_t count : {0U, 1U, 2U, 7U, 100U}) {
      std::vector<int> visits(count);
      executor.halves(count, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) ++visits[i];
      });
      EXPECT_EQ(visits, std::vector<int>(count, 1));
    }
  }
}

struct Tracked {
  std::vector<Fingerprint> frames;
  int tracked = 0, lost = 0;
};

Tracked track(ProceduralSequence& sequence, Config config, TaskPair* pair) {
  Limits limits = Limits::qvga();
  limits.width = sequence.camera().width;
  limits.height = sequence.camera().height;
  limits.kept_keyframes = 1;
  config.references.max_lost_s = 0.03;
  if (pair != nullptr) {
    limits.cores = 2;
    config.executor = pair->executor();
  }
  std::vector<std::byte> memory(required_bytes(limits));
  Odometry odometry;
  const Status status = odometry.init(memory, sequence.camera(), config, limits);
  EXPECT_TRUE(status.ok()) << status.message();
  Tracked result;
  for (int i = 0; i < 16; ++i) {
    const RgbdFrame frame = i >= 6 && i < 9 ? sequence.render_dark(i) : sequence.render(i);
    AllocationGuard guard;
    guard.arm();
    const TrackResult tracked = odometry.track(frame);
    guard.disarm();
    EXPECT_EQ(guard.calls(), 0);
    result.tracked += tracked.state == TrackState::kTracking ? 1 : 0;
    result.lost += tracked.state == TrackState::kLost ? 1 : 0;
    result.frames.push_back(fingerprint_of(tracked));
  }
  return result;
}

TEST(ThreadPair, AnOdometryOnTwoCoresGivesTheSameBits) {
  ThreadPair pair;
  ProceduralSequence sequence(320, 240);
  for (const Features features : {Features::kBoth, Features::kPoints, Features::kLines})
    for (const bool paper : {false, true}) {
      Config config = paper ? Config::paper() : Config();
      config.features = features;
      const Tracked alone = track(sequence, config, nullptr);
      const Tracked together = track(sequence, config, &pair);
      EXPECT_GT(alone.tracked, 6);
      EXPECT_GT(alone.lost, 0);
      ASSERT_EQ(alone.frames.size(), together.frames.size());
      for (std::size_t i = 0; i < alone.frames.size(); ++i)
        EXPECT_EQ(alone.frames[i].value(), together.frames[i].value())
            << "features " << static_cast<int>(features) << (paper ? ", paper" : "") << ", frame " << i;
    }
}

TEST(ThreadPair, RequiresLimitsForTwoCores) {
  ThreadPair pair;
  Config config;
  config.executor = pair.executor();
  Limits limits;
  std::vector<std::byte> memory(2 * required_bytes(limits));
  CameraModel camera = ProceduralSequence(limits.width, limits.height).camera();
  Odometry odometry;
  const Status refused = odometry.init(memory, camera, config, limits);
  EXPECT_EQ(refused.code(), StatusCode::kInvalidArgument);
  EXPECT_TRUE(test::says(refused, "cores")) << refused.message();
  limits.cores = 2;
  EXPECT_GT(required_bytes(limits), required_bytes(Limits()));
  EXPECT_TRUE(odometry.init(memory, camera, config, limits).ok());
  limits.cores = 3;
  EXPECT_FALSE(odometry.init(memory, camera, config, limits).ok());
}

}  // namespace
}  // namespace plvo
