// SPDX-License-Identifier: Apache-2.0
// A mask of the camera's images from C: the bits of C++, and what is refused.
#include <gtest/gtest.h>

#include <cstring>
#include <vector>

#include "c_support.hpp"
#include "procedural_sequence.hpp"

namespace plvo {
namespace {

constexpr int kSeenWide = 320;
constexpr int kSeenHigh = 240;

struct CMask : testing::Test {
  CMask() : used(kSeenWide * kSeenHigh, 255) {
    for (std::size_t i = used.size() * 17 / 20; i < used.size(); ++i) used[i] = 0;
    limits.mask = 1;
    plvo_config_init(&config, sizeof config);
    config.mask = used.data();
    config.mask_width = kSeenWide;
    config.mask_height = kSeenHigh;
  }
  plvo_status init() {
    block.resize(plvo_required_bytes(&limits));
    return plvo_init(block.data(), block.size(), &camera, &config, &limits, &c_odometry);
  }

  ProceduralSequence sequence{kSeenWide, kSeenHigh};
  std::vector<std::uint8_t> used;
  plvo_camera camera = c_camera(sequence.camera());
  plvo_limits limits = c_limits({kSeenWide, kSeenHigh});
  plvo_config config = {};
  std::vector<std::byte> block;
  plvo_odometry* c_odometry = nullptr;
};

TEST_F(CMask, GivesTheBitsOfCpp) {
  Limits known{kSeenWide, kSeenHigh};
  known.mask = true;
  Config config_of_cpp;
  config_of_cpp.mask = {used.data(), kSeenWide, kSeenHigh, kSeenWide};
  std::vector<std::byte> memory(required_bytes(known));
  Odometry odometry;
  ASSERT_TRUE(odometry.init(memory, sequence.camera(), config_of_cpp, known).ok());
  const plvo_status status = init();
  ASSERT_EQ(status.code, PLVO_OK) << status.message;
  for (int i = 0; i < 4; ++i) {
    const RgbdFrame frame = sequence.render(i);
    const plvo_frame view = c_frame(frame);
    plvo_result result = {};
    result.struct_size = sizeof result;
    plvo_track(c_odometry, &view, &result);
    expect_same(odometry.track(frame), result);
  }
  EXPECT_EQ(odometry.features().image.at(5, kSeenHigh - 1), 128) << "masked pixels are grey";
}

TEST_F(CMask, RequiresMemoryAndTheSizeOfTheCamera) {
  const std::size_t with = plvo_required_bytes(&limits);
  limits.mask = 0;
  EXPECT_LT(plvo_required_bytes(&limits), with);
  plvo_status refused = init();
  EXPECT_EQ(refused.code, PLVO_INVALID_ARGUMENT);
  EXPECT_NE(std::strstr(refused.message, "mask needs Limits::mask = true"), nullptr) << refused.message;
  limits.mask = 1;
  config.mask_height = kSeenHigh - 1;
  refused = init();
  EXPECT_EQ(refused.code, PLVO_INVALID_ARGUMENT);
  EXPECT_NE(std::strstr(refused.message, "320x240, not 320x239"), nullptr) << refused.message;
  config.mask_height = kSeenHigh;
  config.mask_stride_bytes = std::int64_t{1} << 31;
  EXPECT_EQ(init().code, PLVO_INVALID_ARGUMENT);
  config.mask_stride_bytes = kSeenWide - 1;
  EXPECT_EQ(init().code, PLVO_INVALID_ARGUMENT);
}

// What lies behind the structs of a program that was compiled before is not the library's to read.
TEST_F(CMask, AProgramWithoutTheFieldHasNoMask) {
  config.struct_size = offsetof(plvo_config, mask);
  limits.struct_size = offsetof(plvo_limits, mask);
  const plvo_status status = init();
  ASSERT_EQ(status.code, PLVO_OK) << status.message;
}

}  // namespace
}  // namespace plvo
