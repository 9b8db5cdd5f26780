// SPDX-License-Identifier: Apache-2.0
// Theorem 1 of the paper, (25) and (26), on every pair of frames of all sequences: with both kinds of
// features, the covariance of the motion is below that with either kind alone, eigenvalue by eigenvalue.
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cstdlib>
#include <string>
#include <vector>

#include "dense.hpp"
#include "motion_information.hpp"
#include "plvo/odometry/features/feature_extraction.hpp"
#include "plvo/odometry/tracking/reference_tracking.hpp"
#include "plvo/replay/recorded_camera.hpp"
#include "procedural_sequence.hpp"

namespace plvo {
namespace {

namespace fs = std::filesystem;

struct Modules {
  FeatureExtraction extraction;
  ReferenceTracking tracking;
  std::array<FrameFeatures, 2> frames;

  constexpr void allocate(Arena& memory, const Limits& limits) {
    for (FrameFeatures& frame : frames) frame.allocate(memory, limits);
    extraction.allocate(memory, limits);
    tracking.allocate(memory, limits);
  }
};

// An estimate from the matches of a pair, and what each kind of its inliers says alone.
struct Fusion {
  MotionEstimate motion;
  Matrix6 I_P, I_L;
};

// Finds the matches by the stages of the odometry itself.
class Pairs {
 public:
  explicit Pairs(const CameraModel& camera) : camera_(camera), memory_(bytes()) {
    config_.surfaces = false;
    arena_ = Arena(memory_);
    modules_.allocate(arena_, Limits::vga());
    arena_.seal();
    modules_.extraction.init(camera_);
  }

  // The motion since the previous frame.
  Fusion next(const RgbdFrame& frame) {
    const NoiseScales noise = initial_scales(config_.noise);
    StageTimes times{};
    CarriedCells carried;
    const StageContext context{camera_, config_, noise, arena_, times, carried, nullptr};
    FeatureExtraction& extraction = modules_.extraction;
    const DepthSampler depth = extraction.depth_sampler(frame, config_.depth_noise);
    PredictedMotion predicted;
    const MotionPrior prior;
    const CurrentFrame current{context, extraction, depth, predicted, modules_.frames[slot_], prior};
    const Limits limits = Limits::vga();
    current.features.clear(
        {static_cast<std::size_t>(limits.keypoints), static_cast<std::size_t>(limits.segments)});
    (void)extraction.prepare_image(context, frame.colour);
    extraction.detect(context, depth, true, current.features);
    current.describe_points();
    TrackedMotion tracked;
    const MotionEstimate& motion = tracked.motion;
    Fusion fusion;
    if (has_reference_) {
      Reference reference;
      reference.features = &modules_.frames[1 - slot_];
      modules_.tracking.find(reference, current, T_predicted_, PointMatchConfig().radius_px, tracked);
      const Se3 T_found = motion.T_current_reference;
      if (tracked.ok()) modules_.tracking.refine({&reference, 1}, current, T_found, false, tracked);
      if (tracked.ok()) fusion = fuse(*reference.features, current.features, motion.T_current_reference);
    } else {
      extraction.lift_lines(context, depth, {}, current.features.lines);
    }
    extraction.lift(context, depth, current.features);
    T_predicted_ = motion.T_current_reference;  // of the next pair
    has_reference_ = true;
    slot_ = 1 - slot_;
    return fusion;
  }

 private:
  // The theorem covers independent kinds, so errors that both share are not modelled here.
  Fusion fuse(const FrameFeatures& reference, const FrameFeatures& current, const Se3& T) {
    const ReferenceTracks& tracks = modules_.tracking.tracks(0);
    Arena memory(estimate_memory_);
    PointConstraints points(reference.points.points, tracks.points.points, tracks.points.matches.span(),
                            PointConstraints::Workspace::take(memory, tracks.points.matches.size()));
    LineConstraints lines(reference.lines.lines_3d(), current.lines.lines_3d(), tracks.lines.span(),
                          LineConstraints::Workspace::take(memory, tracks.lines.size()));
    ConstraintSet* sets[] = {&points, &lines};
    Fusion fusion;
    // The last step, after which H is not computed again, must not matter.
    const LmOptions lm{.max_iterations = 40, .step_tolerance = 1e-10};
    MotionStart start(&T, {}, true);
    start.search_beside = false;  // C_H then contains no other motion
    start.find_shifts = false;    // leaves the terms as C_H was computed from them
    start.registered = config_.points.registered;
    estimate_motion(sets, {}, {}, config_.motion, lm, 1, start, memory, fusion.motion);
    fusion.I_P = test::information_of(points, fusion.motion.T_current_reference);
    fusion.I_L = test::information_of(lines, fusion.motion.T_current_reference);
    return fusion;
  }

  static std::size_t bytes() {
    Arena sizer = Arena::counting();
    Modules modules;
    modules.allocate(sizer, Limits::vga());
    FeatureExtraction::reserve(sizer, Limits::vga());
    ReferenceTracking::reserve(sizer, Limits::vga());
    return sizer.peak() + kArenaAlignment;
  }

  CameraModel camera_;
  Config config_;
  std::vector<std::byte> memory_, estimate_memory_ = std::vector<std::byte>(1 << 22);
  Arena arena_;
  Modules modules_;
  Se3 T_predicted_;
  std::size_t slot_ = 0;
  bool has_reference_ = false;
};

Vector6 eigenvalues(const Matrix6& C) { return test::symmetric_eigenvalues(0.5 * (C + C.transpose())); }

// Returns whether C_H is the covariance of the theorem alone: it may also contain other motions.
bool expect_theorem1(const Fusion& fusion, const std::string& where) {
  const auto& [motion, I_P, I_L] = fusion;
  // (26): Lᵀ C_H L = 1 where I_P + I_L = L Lᵀ. Another motion would add a matrix of rank 1.
  const Matrix6 sum = I_P + I_L;
  const Matrix6 L = Eigen::LLT<Matrix6>(sum).matrixL();
  const Vector6 added = eigenvalues(L.transpose() * motion.C_H * L - Matrix6::Identity());
  EXPECT_GT(added[0], -1e-5) << where;
  EXPECT_LT(added[3], 1e-5) << where;
  // (25). If a kind leaves a direction unconstrained, its C has an infinite eigenvalue and the bound is
  // trivial.
  const Vector6 both = eigenvalues(sum.inverse());
  for (const Matrix6& information : {I_P, I_L}) {
    const Vector6 alone = eigenvalues(information);
    for (int i = 0; i < 6; ++i) {
      if (alone[5 - i] > 1e-9 * alone[5]) {
        EXPECT_LE(both[i], (1 + 1e-9) / alone[5 - i]) << where << ", eigenvalue " << i;
      }
    }
  }
  return added[5] < 1e-5;
}

TEST(Theorem1, HoldsOnEveryPairOfTheProceduralSequence) {
  ProceduralSequence sequence(320, 240);
  Pairs pairs(sequence.camera());
  pairs.next(sequence.render(0));
  for (int i = 1; i < 12; ++i) {
    const Fusion fusion = pairs.next(sequence.render(i));
    const MotionEstimate& motion = fusion.motion;
    ASSERT_EQ(motion.status, StatusCode::kOk) << i;
    EXPECT_GT(motion.inliers[0], 0) << i;
    EXPECT_GT(motion.inliers[1], 0) << i;
    EXPECT_TRUE(expect_theorem1(fusion, "frame " + std::to_string(i))) << i;
  }
}

TEST(Theorem1, HoldsOnEveryPairOfTheRecordedSequences) {
  const char* shared = std::getenv("PLVO_SHARED");
  const fs::path data = fs::path(shared == nullptr ? "" : shared) / "data";
  std::error_code error;
  if (!fs::is_directory(data, error))
    GTEST_SKIP() << "the recorded sequences are not here: set PLVO_SHARED to the folder that holds data/";
  int sequences = 0;
  for (const fs::directory_entry& entry : fs::directory_iterator(data)) {
    if (!fs::exists(entry.path() / "rgb.txt")) continue;
    Calibration calibration;
    ASSERT_TRUE(read_calibration(entry.path() / "calibration.txt", calibration).ok());
    RecordedCamera camera;
    ASSERT_TRUE(camera.open(entry.path(), calibration, {}).ok());
    Pairs pairs(camera.model());
    RgbdFrame frame;
    int frames = 0;
    int solved = 0;
    int alone = 0;
    for (; camera.next(frame).ok(); ++frames) {
      const Fusion fusion = pairs.next(frame);
      if (fusion.motion.status != StatusCode::kOk) continue;
      ++solved;
      const std::string where = entry.path().filename().string() + ", frame " + std::to_string(frames);
      alone += expect_theorem1(fusion, where) ? 1 : 0;
    }
    EXPECT_GE(frames, 5) << entry.path();
    EXPECT_GE(solved, 0.95 * (frames - 1)) << entry.path();
    EXPECT_GE(alone, 0.6 * solved) << entry.path();
    ++sequences;
  }
  EXPECT_GE(sequences, 1);
}

}  // namespace
}  // namespace plvo
