// SPDX-License-Identifier: Apache-2.0
// Any camera with depth of its own: registered as DepthRegistration does it, whatever the stride, size and
// unit.
#include "plvo/replay/images/registered_camera.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace plvo {
namespace {

// A depth camera of half the size, whose rows have a gap.
class RawCamera final : public RgbdCamera {
 public:
  CameraModel model() const override { return {64, 48, {60, 60, 31.5, 23.5}, {}}; }
  Status next(RgbdFrame& frame) override {
    if (failure.ok())
      frame = {1, 2, {nullptr, 64, 48, 192, PixelFormat::kRgb8}, {depth.data(), 32, 24, 40, unit_m}};
    return failure;
  }
  std::vector<std::uint16_t> depth = std::vector<std::uint16_t>(40 * 24, 1500);
  double unit_m = 0.001;
  Status failure;
};

std::vector<std::uint16_t> expected(const RawCamera& source, const DepthCamera& depth) {
  std::vector<std::uint16_t> packed, out(64 * 48);
  for (int v = 0; v < 24; ++v)
    packed.insert(packed.end(), source.depth.begin() + 40 * v, source.depth.begin() + 40 * v + 32);
  DepthRegistration registration;
  registration.init(source.model(), {1, 64, 48}, depth, 32, 24, source.unit_m);
  registration.warp(packed.data(), out.data());
  return out;
}

TEST(RegisteredCamera, RegistersEveryFrame) {
  RawCamera source;
  DepthCamera depth{true, {29, 29, 15.5, 11.5}, 0.05};
  RegisteredCamera camera(source, depth);
  for (const double unit_m : {0.001, 0.001, 0.0001}) {
    source.unit_m = unit_m;
    for (std::size_t i = 0; i < source.depth.size(); ++i)
      source.depth[i] = static_cast<std::uint16_t>(900 + 7 * (i % 90));
    RgbdFrame frame;
    ASSERT_TRUE(camera.next(frame).ok());
    EXPECT_EQ(frame.depth_stamp_ns, 2);
    ASSERT_EQ(frame.depth.width * 1000 + frame.depth.height, 64048);
    EXPECT_EQ(frame.depth.metres_per_unit, unit_m);
    const std::vector<std::uint16_t> wanted = expected(source, depth);
    EXPECT_TRUE(std::equal(wanted.begin(), wanted.end(), frame.depth.data));
    EXPECT_GT(std::count_if(wanted.begin(), wanted.end(), [](std::uint16_t d) { return d > 0; }), 1000);
  }
}

TEST(RegisteredCamera, AFailureIsTheSources) {
  RawCamera source;
  source.failure = {StatusCode::kUnplugged, "gone"};
  RegisteredCamera camera(source, {true, {29, 29, 15.5, 11.5}});
  RgbdFrame frame;
  EXPECT_EQ(camera.next(frame).code(), StatusCode::kUnplugged);
}

}  // namespace
}  // namespace plvo
