// SPDX-License-Identifier: Apache-2.0
// The time budget: the steps that follow from given durations, and their effect on the features of a frame.
// Also the hook between stages.
#include "plvo/odometry/features/feature_budget.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "fingerprint.hpp"
#include "plvo/odometry/odometry.hpp"
#include "procedural_sequence.hpp"

namespace plvo {
namespace {

constexpr std::int64_t kBudget = 1000;
constexpr std::int64_t kTooLong = 1001, kInTime = 800, kQuick = 500;
constexpr BudgetConfig kConfig{.frame_ns = kBudget, .patience_frames = 5, .spare_share = 0.6};

FeatureBudget make_budget(const BudgetConfig& config = kConfig) {
  FeatureBudget budget;
  budget.init(config, Limits::vga());
  return budget;
}

void note(FeatureBudget& budget, std::int64_t took_ns, int times) {
  for (int i = 0; i < times; ++i) budget.note(took_ns);
}

TEST(FeatureBudget, EachStepRemovesAQuarterOfAlternatingKinds) {
  FeatureBudget budget = make_budget();
  std::vector<std::size_t> keypoints{budget.capacity().keypoints}, segments{budget.capacity().segments};
  for (int i = 0; i < FeatureBudget::kSteps; ++i) {
    note(budget, kTooLong, 1 + FeatureBudget::kSettlingFrames);
    EXPECT_EQ(budget.step(), i + 1);
    keypoints.push_back(budget.capacity().keypoints);
    segments.push_back(budget.capacity().segments);
  }
  EXPECT_EQ(keypoints, (std::vector<std::size_t>{400, 300, 300, 225, 225, 169, 169, 127, 127}));
  EXPECT_EQ(segments, (std::vector<std::size_t>{256, 256, 192, 192, 144, 144, 108, 108, 81}));
  note(budget, kTooLong, 10);
  EXPECT_EQ(budget.step(), FeatureBudget::kSteps) << "there is no further step";
}

TEST(FeatureBudget, KeepsAMinimumUnlessThereWereFewer) {
  FeatureBudget budget;
  budget.init(kConfig, {160, 120, 60, 12});
  note(budget, kTooLong, 100);
  EXPECT_EQ(budget.capacity().keypoints, 40U);
  EXPECT_EQ(budget.capacity().segments, 12U);
}

TEST(FeatureBudget, IgnoresTheFramesAfterAStep) {
  FeatureBudget budget = make_budget();
  budget.note(kTooLong);
  note(budget, kTooLong, FeatureBudget::kSettlingFrames);
  EXPECT_EQ(budget.step(), 1);
  budget.note(kTooLong);
  EXPECT_EQ(budget.step(), 2);
}

TEST(FeatureBudget, GoesUpAfterEnoughQuickFramesInARow) {
  FeatureBudget budget = make_budget();
  note(budget, kTooLong, 2 * (1 + FeatureBudget::kSettlingFrames));
  ASSERT_EQ(budget.step(), 2);
  note(budget, kInTime, 100);
  EXPECT_EQ(budget.step(), 2) << "within the budget, but without time to spare";
  note(budget, kQuick, 4);
  budget.note(kInTime);
  note(budget, kQuick, 4);
  EXPECT_EQ(budget.step(), 2) << "not in a row";
  budget.note(kQuick);
  EXPECT_EQ(budget.step(), 1);
  note(budget, kQuick, FeatureBudget::kSettlingFrames + 5);
  EXPECT_EQ(budget.step(), 0);
  note(budget, kQuick, 100);
  EXPECT_EQ(budget.step(), 0) << "there is nothing above all the features";
}

TEST(FeatureBudget, HasNoEffectWithoutABudget) {
  FeatureBudget budget = make_budget(BudgetConfig{});
  note(budget, 1'000'000'000'000, 10);
  EXPECT_EQ(budget.step(), 0);
}

class BudgetedOdometry : public ::testing::Test {
 protected:
  static constexpr Limits kLimits = Limits::qvga();

  void init(const Config& config) {
    memory_.resize(required_bytes(kLimits));
    ASSERT_TRUE(odometry_.init(memory_, sequence_.camera(), config, kLimits).ok());
  }
  static Config budgeted() {
    Config config;
    config.budget = kConfig;
    return config;
  }
  static std::uint64_t bits(const TrackResult& result) {
    Fingerprint print;
    print.add(result.T_world_camera.R);
    print.add(result.T_world_camera.t);
    print.add(result.pose_covariance);
    print.add(result.feature_step);
    return print.value();
  }

  ProceduralSequence sequence_{kLimits.width, kLimits.height};
  std::vector<std::byte> memory_;
  Odometry odometry_;
};

TEST_F(BudgetedOdometry, KeepsAsManyFeaturesAsTheStepSays) {
  Config config = budgeted();
  config.references.policy = ReferencePolicy::kPreviousFrame;  // points are detected in every frame
  init(config);
  const std::vector<int> steps = {0, 1, 1, 1, 2, 2, 2, 3};
  FeatureBudget expected;
  expected.init(kConfig, kLimits);
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const TrackResult result = odometry_.track(sequence_.render(static_cast<int>(i)));
    EXPECT_EQ(result.feature_step, steps[i]);
    EXPECT_EQ(odometry_.features().keypoints.size(), expected.capacity().keypoints)
        << "there is enough texture";
    EXPECT_LE(odometry_.features().segments.size(), expected.capacity().segments);
    EXPECT_GT(result.points.dropped, 0);
    if (i > 0) {
      EXPECT_EQ(result.state, TrackState::kTracking);
    }
    odometry_.frame_took(kTooLong);
    expected.note(kTooLong);
  }
}

// A keyframe from before a step would still cost as much time as it did then.
TEST_F(BudgetedOdometry, ReplacesAKeyframeWithTooManyFeatures) {
  Config config = budgeted();
  config.references.keyframe_inlier_ratio = 0;  // it would stay for ever
  init(config);
  TrackResult result;
  for (int i = 0; i < 3; ++i) result = odometry_.track(sequence_.render(i));
  EXPECT_EQ(result.reference_stamp_ns, sequence_.stamp_ns(0));
  odometry_.frame_took(kTooLong);
  (void)odometry_.track(sequence_.render(3));
  result = odometry_.track(sequence_.render(4));
  EXPECT_EQ(result.reference_stamp_ns, sequence_.stamp_ns(3));
  result = odometry_.track(sequence_.render(5));
  EXPECT_EQ(result.reference_stamp_ns, sequence_.stamp_ns(3));
}

TEST_F(BudgetedOdometry, EqualDurationsGiveEqualBits) {
  const auto track = [this](const Config& config, bool tell) {
    init(config);
    std::vector<std::uint64_t> prints;
    for (int i = 0; i < 10; ++i) {
      prints.push_back(bits(odometry_.track(sequence_.render(i))));
      if (tell) odometry_.frame_took(i < 5 ? kTooLong : kQuick);
    }
    return prints;
  };
  const auto first = track(budgeted(), true);
  EXPECT_EQ(track(budgeted(), true), first);
  const auto plain = track(Config{}, false);
  EXPECT_NE(plain, first);
  EXPECT_EQ(track(Config{}, true), plain) << "durations have no effect without a budget";
  EXPECT_EQ(track(budgeted(), false), plain) << "a budget has no effect without durations";
}

TEST_F(BudgetedOdometry, RefusesABudgetOutOfRange) {
  for (const BudgetConfig& wrong :
       {BudgetConfig{.frame_ns = -1}, BudgetConfig{.frame_ns = 1, .patience_frames = 0},
        BudgetConfig{.frame_ns = 1, .spare_share = 1.5}}) {
    Config config;
    config.budget = wrong;
    EXPECT_EQ(config.validate().code(), StatusCode::kInvalidArgument);
  }
}

TEST_F(BudgetedOdometry, CallsTheHookAfterEachStage) {
  std::vector<Stage> stages;
  Config config;
  config.stage_hook = {
      [](void* context, Stage stage) { static_cast<std::vector<Stage>*>(context)->push_back(stage); },
      &stages};
  init(config);
  (void)odometry_.track(sequence_.render(0));
  EXPECT_EQ(stages,
            (std::vector{Stage::kImage, Stage::kPoints, Stage::kLines, Stage::kLines, Stage::kPoints}))
      << "a keyframe's points are described last";
  // The second frame gives the velocity. With it the aligned motion is near the predicted one, so one search
  // suffices.
  (void)odometry_.track(sequence_.render(1));
  stages.clear();
  (void)odometry_.track(sequence_.render(2));
  EXPECT_EQ(stages, (std::vector{Stage::kImage, Stage::kLines, Stage::kMatching, Stage::kLines,
                                 Stage::kMatching, Stage::kMatching, Stage::kMotion}))
      << "the frame is aligned, and both references are matched";
}

}  // namespace
}  // namespace plvo
