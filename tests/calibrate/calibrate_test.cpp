// SPDX-License-Identifier: Apache-2.0
// Tests the parts of a calibration: the quadratic minimum and its covariance, the refused inputs, and the
// bitwise independence of threads and repetition.
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <limits>
#include <memory>
#include <numeric>

#include "plvo/base/random.hpp"
#include "plvo/calibrate/quadratic_fit.hpp"
#include "plvo/calibrate/stamp_jitter.hpp"
#include "plvo/calibrate/timing_report.hpp"
#include "plvo/calibrate/timing_search.hpp"
#include "plvo/simulator/simulated_camera.hpp"
#include "temporary_folder.hpp"
#include "turning_hand.hpp"

namespace plvo {
namespace {

using namespace calibrate;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Returns the costs of blocks whose minimum scatters around `place`, with the curvature of `weights`.
MatrixXd costs_of(const MatrixXd& design, const VectorXd& place, const VectorXd& weights, double scatter,
                  int pieces) {
  Random random(3);
  MatrixXd costs(pieces, design.rows());
  for (int piece = 0; piece < pieces; ++piece) {
    VectorXd own = place;
    for (Eigen::Index i = 0; i < own.size(); ++i) own(i) += scatter * (2 * random.uniform() - 1);
    for (Eigen::Index row = 0; row < design.rows(); ++row) {
      const VectorXd d = design.row(row).transpose() - own;
      costs(piece, row) = 5 + d.cwiseProduct(weights).dot(d) + (d.size() > 1 ? 0.3 * d(0) * d(1) : 0);
    }
  }
  return costs;
}

// Returns frames 33.4 ms apart with a stamp error of up to ± `most_s`; one frame in seven is missing.
TrackedRecording stamped(int frames, double most_s, std::int64_t start_ns) {
  Random random(11);
  TrackedRecording recording;
  for (int i = 0; i < frames; ++i) {
    if (i % 7 == 3) continue;
    TrackedFrame frame;
    frame.stamp_ns =
        start_ns + 33'400'000LL * i + static_cast<std::int64_t>(1e9 * most_s * (2 * random.uniform() - 1));
    recording.frames.push_back(frame);
  }
  return recording;
}

TEST(StampJitter, IsTheDeviationFromAConstantRate) {
  // The errors are uniform over ± 3 ms: a standard deviation of 1.732 ms. The second recording has its own
  // clock.
  const std::vector<TrackedRecording> two = {stamped(300, 0.003, 0), stamped(200, 0.003, 77'123'456'789)};
  EXPECT_NEAR(stamp_jitter_s(two), 0.003 / std::sqrt(3), 0.0001);
  EXPECT_LT(stamp_jitter_s(std::vector{stamped(300, 0, 5)}), 1e-9);
}

TEST(StampJitter, IsUnknownForTooFewFramesOrAVaryingRate) {
  EXPECT_LT(stamp_jitter_s({}), 0);
  EXPECT_LT(stamp_jitter_s(std::vector{stamped(15, 0.003, 0)}), 0);
  // An exposure time that follows the light: frames 33 to 100 ms apart.
  TrackedRecording slow;
  Random random(5);
  for (std::int64_t stamp_ns = 0; slow.frames.size() < 200;
       stamp_ns += static_cast<std::int64_t>(33e6 * (1 + 2 * random.uniform()))) {
    slow.frames.emplace_back();
    slow.frames.back().stamp_ns = stamp_ns;
  }
  EXPECT_LT(stamp_jitter_s(std::vector{slow}), 0);
}

TEST(QuadraticFit, FindsTheMinimumAndItsCovariance) {
  for (const int unknowns : {1, 2, 3}) {
    SCOPED_TRACE(unknowns);
    const MatrixXd design = quadratic_design(unknowns);
    VectorXd place(unknowns), weights(unknowns);
    for (int i = 0; i < unknowns; ++i) {
      place(i) = 0.3 - 0.2 * i;
      weights(i) = 1 + i;
    }
    const QuadraticMinimum exact = fit_quadratic(design, costs_of(design, place, weights, 0, 20));
    ASSERT_TRUE(exact.convex);
    EXPECT_LT((exact.place - place).norm(), 1e-9);
    EXPECT_LT(exact.covariance.norm(), 1e-12);
    // The minima are uniform over ±0.4 in each of 100 blocks: a standard deviation of 0.231 each, 0.0231 of
    // their mean.
    const QuadraticMinimum scattered = fit_quadratic(design, costs_of(design, place, weights, 0.4, 100));
    ASSERT_TRUE(scattered.convex);
    for (int i = 0; i < unknowns; ++i) {
      EXPECT_NEAR(std::sqrt(scattered.covariance(i, i)), 0.0231, 0.005);
      EXPECT_NEAR(scattered.place(i), place(i), 4 * 0.0231);
    }
  }
}

TEST(QuadraticFit, ConcaveCriterionHasNoMinimum) {
  const MatrixXd design = quadratic_design(1);
  const MatrixXd ridge = -costs_of(design, VectorXd::Constant(1, 0.1), VectorXd::Constant(1, 1.0), 0.1, 10);
  const QuadraticMinimum minimum = fit_quadratic(design, ridge);
  EXPECT_FALSE(minimum.convex);
  EXPECT_EQ(std::abs(minimum.place(0)), 1);  // the best of the measured places
  EXPECT_FALSE(minimum.covariance.allFinite());
}

// Repeats the first `frames` images of a simulated recording.
class Film final : public RgbdCamera {
 public:
  explicit Film(RgbdCamera& camera, int frames, int copies = 1) : model_(camera.model()) {
    for (int i = 0; i < frames; ++i) {
      RgbdFrame frame;
      EXPECT_TRUE(camera.next(frame).ok());
      Shot shot;
      shot.colour.assign(frame.colour.data,
                         frame.colour.data + frame.colour.stride_bytes * frame.colour.height);
      shot.depth.assign(frame.depth.data, frame.depth.data + frame.depth.stride * frame.depth.height);
      shot.frame = frame;
      for (int copy = 0; copy < copies; ++copy) {
        shots_.push_back(shot);
        shots_.back().frame.stamp_ns += std::int64_t{33'333'000} * copy;
        shots_.back().frame.depth_stamp_ns += std::int64_t{33'333'000} * copy;
      }
    }
  }
  CameraModel model() const override { return model_; }
  Status next(RgbdFrame& frame) override {
    if (next_ == shots_.size()) return {StatusCode::kEndOfStream, "the end"};
    const Shot& shot = shots_[next_++];
    frame = shot.frame;
    frame.colour.data = shot.colour.data();
    frame.depth.data = shot.depth.data();
    return {};
  }
  void rewind() { next_ = 0; }

 private:
  struct Shot {
    RgbdFrame frame;
    std::vector<std::uint8_t> colour;
    std::vector<std::uint16_t> depth;
  };
  CameraModel model_;
  std::vector<Shot> shots_;
  std::size_t next_ = 0;
};

SimulatorOptions small_desk() {
  SimulatorOptions options;
  options.scene = SceneName::kDesk;
  options.camera.width = 320;
  options.camera.height = 240;
  options.camera.pinhole = {262.5, 262.5, 159.5, 119.5};
  return options;
}

TimingSearch search_of(Film& film) {
  TimingSearch search;
  search.find_readouts = false;
  search.track = [&film](const SensorTiming& timing, std::vector<TrackedRecording>& recordings) {
    film.rewind();
    recordings.emplace_back();
    return track_recording(
        film, with_timing(film.model(), timing), 1000, [] {}, recordings.back());
  };
  return search;
}

TEST(FindTiming, RefusesUninformativeRecordingsWithAdvice) {
  std::unique_ptr<SimulatedCamera> camera;
  ASSERT_TRUE(SimulatedCamera::create(small_desk(), camera).ok());
  Film still(*camera, 1, 60);
  TimingResult result;
  const Status at_rest = find_timing(search_of(still), result);
  EXPECT_EQ(at_rest.code(), StatusCode::kDegenerate);
  EXPECT_NE(std::string(at_rest.message()).find("turn the camera"), std::string::npos) << at_rest.message();
  Film brief(*camera, 5);
  const Status too_short = find_timing(search_of(brief), result);
  EXPECT_EQ(too_short.code(), StatusCode::kTooFewFeatures);
  EXPECT_NE(std::string(too_short.message()).find("record 10 s or more"), std::string::npos)
      << too_short.message();
}

TEST(FindTiming, ResultIsIndependentOfThreadsAndRepetition) {
  const test::TemporaryFolder folder;
  test::write_file(folder / "hand.txt", test::turning_hand(1));
  SimulatorOptions options = small_desk();
  options.trajectory_file = (folder / "hand.txt").string();
  std::unique_ptr<SimulatedCamera> camera;
  ASSERT_TRUE(SimulatedCamera::create(options, camera).ok());
  Film film(*camera, 16);
  std::vector<TrackedRecording> recordings(1);
  ASSERT_TRUE(track_recording(
                  film, with_timing(film.model(), {}), 1000, [] {}, recordings[0])
                  .ok());
  ASSERT_GE(recordings[0].pairs.size(), 12u);
  const SensorTiming timing{0.004, 0.01, 0.02};
  const std::vector<double> alone = disagreement(recordings, timing, 1, 1);
  EXPECT_EQ(alone.size(), recordings[0].pairs.size());
  EXPECT_EQ(alone, disagreement(recordings, timing, 1, 3));
  const std::vector<double> every_third = disagreement(recordings, timing, 3, 2);
  ASSERT_EQ(every_third.size(), (alone.size() + 2) / 3);
  for (std::size_t i = 0; i < every_third.size(); ++i) EXPECT_EQ(every_third[i], alone[3 * i]);
  // A wrong timing has a higher cost.
  const auto sum = [](const std::vector<double>& v) { return std::accumulate(v.begin(), v.end(), 0.0); };
  EXPECT_LT(sum(disagreement(recordings, {}, 1, 1)), sum(disagreement(recordings, {0.03, 0, 0}, 1, 1)));
}

TEST(TimingReport, ThePageShowsEveryCurveAndLoadsNothing) {
  TimingResult result;
  result.timing = {-0.015, 0.02, 0.026};
  result.sigma_s = {0.0004, 0.001, std::numeric_limits<double>::infinity()};
  for (std::vector<CurvePoint>& curve : result.curves) curve = {{-0.02, 9}, {-0.015, 7}, {-0.01, 9.5}};
  EXPECT_TRUE(is_determined(result, 1));
  EXPECT_FALSE(is_determined(result, 2));
  const std::string page = to_html(result, {"a<b"});
  std::size_t curves = 0;
  for (std::size_t at = 0; (at = page.find("<polyline", at)) != page.npos; ++at) ++curves;
  EXPECT_EQ(curves, 3u);
  EXPECT_NE(page.find("-15.00 ms, SD 0.40 ms"), page.npos);
  EXPECT_NE(page.find("not shown by these recordings"), page.npos);
  EXPECT_NE(page.find("a&lt;b"), page.npos);
  for (const char* loaded : {"http", "src=", "href=", "nan", "inf"})
    EXPECT_EQ(page.find(loaded), page.npos) << loaded;
}

}  // namespace
}  // namespace plvo
