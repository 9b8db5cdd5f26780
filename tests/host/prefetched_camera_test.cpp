// SPDX-License-Identifier: Apache-2.0
// A camera read ahead gives what the camera gives, one call after the other: frames, whole, for as long as
// they may be looked at, and troubles in their places.
#include "plvo/host/prefetched_camera.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <string>
#include <thread>
#include <vector>

#include "allocation_guard.hpp"

namespace plvo {
namespace {

constexpr int kColumns = 5;
constexpr int kLines = 4;

// Call n comes to what is told; of a frame every pixel says n, and the pixels are the same for each.
class ToldCamera final : public RgbdCamera {
 public:
  explicit ToldCamera(std::vector<StatusCode> told) : told_(std::move(told)) {}

  CameraModel model() const override {
    CameraModel model;
    model.width = kColumns;
    model.height = kLines;
    return model;
  }
  Status next(RgbdFrame& frame) override {
    const auto n = static_cast<std::size_t>(calls_++);
    std::fill(colour_.begin(), colour_.end(), static_cast<std::uint8_t>(n));
    std::fill(depth_.begin(), depth_.end(), static_cast<std::uint16_t>(n));
    frame.stamp_ns = static_cast<std::int64_t>(n);
    frame.depth_stamp_ns = static_cast<std::int64_t>(n) + 1;
    const StatusCode code = n < told_.size() ? told_[n] : StatusCode::kEndOfStream;
    if (code != StatusCode::kOk) return Status(code, "call ").append(static_cast<std::ptrdiff_t>(n));
    frame.colour = {colour_.data(), kColumns, kLines, kStride, PixelFormat::kRgb8};
    frame.depth = {depth_.data(), kColumns, kLines, kColumns, 0.002};
    return {};
  }
  int calls() const { return calls_; }

 private:
  static constexpr int kStride = 3 * kColumns + 1;
  std::vector<StatusCode> told_;
  std::vector<std::uint8_t> colour_ = std::vector<std::uint8_t>(kStride * kLines);
  std::vector<std::uint16_t> depth_ = std::vector<std::uint16_t>(kColumns * kLines);
  std::atomic<int> calls_ = 0;
};

void expect_all_say(int n, const RgbdFrame& frame) {
  EXPECT_EQ(frame.stamp_ns, n);
  EXPECT_EQ(frame.depth_stamp_ns, n + 1);
  ASSERT_EQ(frame.colour.width, kColumns);
  ASSERT_EQ(frame.colour.height, kLines);
  ASSERT_EQ(frame.depth.width, kColumns);
  ASSERT_EQ(frame.depth.height, kLines);
  EXPECT_EQ(frame.depth.metres_per_unit, 0.002);
  for (int y = 0; y < kLines; ++y) {
    for (int x = 0; x < kColumns; ++x) {
      ASSERT_EQ(frame.colour.data[y * frame.colour.stride_bytes + 3 * x + 1], static_cast<std::uint8_t>(n));
      ASSERT_EQ(frame.depth.data[y * frame.depth.stride + x], static_cast<std::uint16_t>(n));
    }
  }
}

TEST(PrefetchedCamera, GivesWhatTheCameraGivesInItsOrder) {
  using enum StatusCode;
  const std::vector<StatusCode> told = {kOk, kDamaged, kOk, kOk, kTimeout, kUnplugged, kOk, kDamaged, kOk};
  ToldCamera camera(told);
  PrefetchedCamera prefetched(camera);
  EXPECT_EQ(prefetched.model().width, kColumns);
  for (std::size_t n = 0; n < told.size(); ++n) {
    RgbdFrame frame;
    const Status status = prefetched.next(frame);
    ASSERT_EQ(status.code(), told[n]);
    if (status.ok()) {
      expect_all_say(static_cast<int>(n), frame);
    } else {
      EXPECT_EQ(status.message(), std::string("call ") + std::to_string(n));
      EXPECT_EQ(frame.stamp_ns, static_cast<std::int64_t>(n));
      EXPECT_EQ(frame.colour.data, nullptr);
    }
  }
}

TEST(PrefetchedCamera, IsAskedNoMoreAfterTheEndWhichStays) {
  for (const StatusCode last : {StatusCode::kEndOfStream, StatusCode::kIo}) {
    ToldCamera camera({StatusCode::kOk, last, StatusCode::kOk});
    PrefetchedCamera prefetched(camera);
    RgbdFrame frame;
    ASSERT_TRUE(prefetched.next(frame).ok());
    for (int i = 0; i < 3; ++i) EXPECT_EQ(prefetched.next(frame).code(), last);
    EXPECT_EQ(camera.calls(), 2);
  }
}

// Two frames ahead, of which none takes the place of the one that is looked at.
TEST(PrefetchedCamera, ReadsAheadAndLeavesTheFrameThatIsLookedAt) {
  ToldCamera camera(std::vector<StatusCode>(20, StatusCode::kOk));
  PrefetchedCamera prefetched(camera);
  for (int n = 0; n < 20; ++n) {
    RgbdFrame frame;
    ASSERT_TRUE(prefetched.next(frame).ok());
    prefetched.wait_until_ahead();
    EXPECT_EQ(camera.calls(), n < 18 ? n + 3 : 21);  // the last call finds the end
    expect_all_say(n, frame);
  }
}

TEST(PrefetchedCamera, AllocatesNothingPerFrame) {
  ToldCamera camera(std::vector<StatusCode>(50, StatusCode::kOk));
  PrefetchedCamera prefetched(camera);
  AllocationGuard guard;
  for (int n = 0; n < 50; ++n) {
    RgbdFrame frame;
    [[maybe_unused]] const Status told = prefetched.next(frame);
  }
  EXPECT_EQ(guard.calls(), 0);
}

TEST(PrefetchedCamera, EndsWithoutACallOfNext) {
  ToldCamera camera(std::vector<StatusCode>(20, StatusCode::kOk));
  { const PrefetchedCamera prefetched(camera); }
  EXPECT_LE(camera.calls(), 2);
}

}  // namespace
}  // namespace plvo
