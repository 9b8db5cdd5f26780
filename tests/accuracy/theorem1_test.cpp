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

// Runs the stages of the odometry itself, because its result does not contain the estimate.
class Pairs {
 public:
  explicit Pairs(const CameraModel& camera) : camera_(camera), memory_(bytes()) {
    // The theorem covers independent kinds: errors that both share are switched off.
    config_.noise.angular_rate_error_rad_per_s = config_.noise.shared_depth_m = 0;
    config_.surfaces = false;
    arena_ = Arena(memory_);
    modules_.allocate(arena_, Limits::vga());
    arena_.seal();
    modules_.extraction.init(camera_);
  }

  // The motion since the previous frame.
  MotionEstimate next(const RgbdFrame& frame) {
    const NoiseScales noise = config_.noise.initial;
    StageTimes times{};
    CarriedCells carried;
    const StageContext context{camera_, config_, noise, arena_, times, carried};
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
    if (has_reference_) {
      Reference reference;
      reference.features = &modules_.frames[1 - slot_];
      modules_.tracking.find(reference, current, T_predicted_, PointMatchConfig().radius_px, tracked);
      const Se3 T_found = motion.T_current_reference;
      if (tracked.ok()) modules_.tracking.refine({&reference, 1}, current, T_found, tracked);
    } else {
      extraction.lift_lines(context, depth, {}, current.features.lines);
    }
    extraction.lift(context, depth, current.features);
    T_predicted_ = motion.T_current_reference;  // of the next pair
    has_reference_ = true;
    slot_ = 1 - slot_;
    return motion;
  }

 private:
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
  std::vector<std::byte> memory_;
  Arena arena_;
  Modules modules_;
  Se3 T_predicted_;
  std::size_t slot_ = 0;
  bool has_reference_ = false;
};

Vector6 eigenvalues(const Matrix6& C) { return test::symmetric_eigenvalues(0.5 * (C + C.transpose())); }

// Returns whether C_H is the covariance of the theorem alone: it may also contain other motions.
bool expect_theorem1(const MotionEstimate& motion, const std::string& where) {
  const Matrix6& I_P = motion.information[0];
  const Matrix6& I_L = motion.information[1];
  // (26): Lᵀ C_H L = 1 where I_P + I_L = L Lᵀ. Each other motion, of RANSAC and of a glance, adds a matrix of
  // rank 1.
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
    const MotionEstimate motion = pairs.next(sequence.render(i));
    ASSERT_EQ(motion.status, StatusCode::kOk) << i;
    EXPECT_GT(motion.inliers[0], 0) << i;
    EXPECT_GT(motion.inliers[1], 0) << i;
    EXPECT_TRUE(expect_theorem1(motion, "frame " + std::to_string(i))) << i;
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
      const MotionEstimate motion = pairs.next(frame);
      if (motion.status != StatusCode::kOk) continue;
      ++solved;
      const std::string where = entry.path().filename().string() + ", frame " + std::to_string(frames);
      alone += expect_theorem1(motion, where) ? 1 : 0;
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
