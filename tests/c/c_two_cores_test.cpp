// SPDX-License-Identifier: Apache-2.0
// A second core and a hook between stages, from C: the page's functions and functions of the caller's own.
// The bits are those of C++ on one core.
#include <gtest/gtest.h>

#include <thread>
#include <vector>

#include "c_support.hpp"
#include "page_functions.h"
#include "plvo/c/thread_pair.h"
#include "procedural_sequence.hpp"

namespace plvo {
namespace {

struct Runs {
  int count = 0;
};
// One task after the other, as a board may that has a single core.
void run_here(void* runs, plvo_task here, plvo_task beside) {
  ++static_cast<Runs*>(runs)->count;
  beside.call(beside.context);
  here.call(here.context);
}
void note_stage(void* stages, std::int32_t stage) {
  static_cast<std::vector<std::int32_t>*>(stages)->push_back(stage);
}

struct CTwoCores : testing::Test {
  void SetUp() override {
    limits.cores = 2;
    plvo_config_init(&config, sizeof config);
    memory.resize(required_bytes(Limits()));
    ASSERT_TRUE(odometry.init(memory, sequence.camera(), {}, Limits()).ok());
  }
  plvo_status init() {
    block.resize(plvo_required_bytes(&limits));
    return plvo_init(block.data(), block.size(), &camera, &config, &limits, &c_odometry);
  }
  // Found, lost in the dark, and found again.
  void expect_the_bits_of_one_core(plvo_odometry* on_two) {
    int tracked = 0;
    for (int i = 0; i < 10; ++i) {
      const RgbdFrame frame = i == 5 ? sequence.render_dark(i) : sequence.render(i);
      const plvo_frame view = c_frame(frame);
      plvo_result result = {};
      result.struct_size = sizeof result;
      plvo_track(on_two, &view, &result);
      expect_same(odometry.track(frame), result);
      tracked += result.state == PLVO_TRACKING ? 1 : 0;
    }
    EXPECT_GE(tracked, 7);
  }

  ProceduralSequence sequence{320, 240};
  plvo_camera camera = c_camera(sequence.camera());
  plvo_limits limits = c_limits(Limits());
  plvo_config config = {};
  std::vector<std::byte> memory, block;
  Odometry odometry;
  plvo_odometry* c_odometry = nullptr;
};

TEST_F(CTwoCores, ThePagesFunctionGivesTheSameBits) {
  plvo_thread_pair* pair = nullptr;
  ASSERT_EQ(plvo_thread_pair_start(&pair).code, PLVO_OK);
  std::vector<std::int32_t> stages;
  const plvo_status status = start_on_two_cores(pair, &camera, note_stage, &stages, &c_odometry);
  ASSERT_EQ(status.code, PLVO_OK) << status.message;
  expect_the_bits_of_one_core(c_odometry);
  EXPECT_GT(plvo_thread_pair_cpu_ns(pair), 0) << "the second thread had something to do";
  ASSERT_GT(stages.size(), 30U);
  stages.resize(3);
  EXPECT_EQ(stages, (std::vector<std::int32_t>{PLVO_STAGE_IMAGE, PLVO_STAGE_POINTS, PLVO_STAGE_LINES}));
  plvo_thread_pair_stop(pair);
}

TEST_F(CTwoCores, GivesTheSameBitsWithAnExecutorOfTheCaller) {
  Runs runs;
  config.executor = run_here;
  config.executor_runner = &runs;
  const plvo_status status = init();
  ASSERT_EQ(status.code, PLVO_OK) << status.message;
  expect_the_bits_of_one_core(c_odometry);
  EXPECT_GT(runs.count, 20);
}

TEST_F(CTwoCores, EachTaskHasAThreadOfItsOwn) {
  plvo_thread_pair* pair = nullptr;
  ASSERT_EQ(plvo_thread_pair_start(&pair).code, PLVO_OK);
  std::thread::id here, beside;
  const auto note = [](void* id) { *static_cast<std::thread::id*>(id) = std::this_thread::get_id(); };
  plvo_thread_pair_run(pair, {note, &here}, {note, &beside});
  EXPECT_EQ(here, std::this_thread::get_id());
  EXPECT_NE(beside, std::thread::id());
  EXPECT_NE(beside, here);
  plvo_thread_pair_stop(pair);
  plvo_thread_pair_stop(nullptr);
  EXPECT_EQ(plvo_thread_pair_start(nullptr).code, PLVO_INVALID_ARGUMENT);
}

TEST_F(CTwoCores, RequireLimitsForTwoCores) {
  Runs runs;
  config.executor = run_here;
  config.executor_runner = &runs;
  const std::size_t of_two = plvo_required_bytes(&limits);
  limits.cores = 0;
  EXPECT_LT(plvo_required_bytes(&limits), of_two);
  const plvo_status refused = init();
  EXPECT_EQ(refused.code, PLVO_INVALID_ARGUMENT);
  EXPECT_NE(std::strstr(refused.message, "cores = 2"), nullptr) << refused.message;
  limits.cores = 3;
  EXPECT_EQ(plvo_required_bytes(&limits), 0U);
}

// What lies behind the structs of a program that was compiled before is not the library's to read or to call.
TEST_F(CTwoCores, AnOlderProgramHasOneCore) {
  config.executor = [](void*, plvo_task, plvo_task) { ADD_FAILURE() << "called"; };
  config.stage_hook = [](void*, std::int32_t) { ADD_FAILURE() << "called"; };
  config.struct_size = offsetof(plvo_config, stage_hook);
  limits.cores = 77;
  limits.struct_size = offsetof(plvo_limits, cores);
  const plvo_status status = init();
  ASSERT_EQ(status.code, PLVO_OK) << status.message;
  expect_the_bits_of_one_core(c_odometry);
}

}  // namespace
}  // namespace plvo
