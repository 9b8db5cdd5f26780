// SPDX-License-Identifier: Apache-2.0
// The public API for C gives the bits of the C++ one, takes no memory, and answers nonsense with words.
#include <gtest/gtest.h>

#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "allocation_guard.hpp"
#include "c_support.hpp"
#include "plvo/odometry/odometry.hpp"
#include "procedural_sequence.hpp"

namespace plvo {
namespace {

constexpr Limits kLimits = Limits::qvga();

// Both doors with the same settings.
struct Doors {
  explicit Doors(const Config& config = {}, const plvo_config* c_config = nullptr, std::size_t offset = 0)
      : Doors(config, c_config, kLimits, c_limits(kLimits), offset) {}
  Doors(const Config& config, const plvo_config* c_config, const Limits& limits, const plvo_limits& given,
        std::size_t offset = 0) {
    memory.resize(required_bytes(limits));
    c_memory.resize(plvo_required_bytes(&given) + offset);
    const plvo_camera camera = c_camera(sequence.camera());
    const Status status = odometry.init(memory, sequence.camera(), config, limits);
    EXPECT_TRUE(status.ok()) << status.message();
    const plvo_status c_status =
        plvo_init(c_memory.data() + offset, c_memory.size() - offset, &camera, c_config, &given, &c_odometry);
    EXPECT_EQ(c_status.code, PLVO_OK) << c_status.message;
  }
  ProceduralSequence sequence{kLimits.width, kLimits.height};
  std::vector<std::byte> memory, c_memory;
  Odometry odometry;
  plvo_odometry* c_odometry = nullptr;
};

int tracked_alike(Doors& doors, int frames) {
  int tracked = 0;
  for (int i = 0; i < frames; ++i) {
    const RgbdFrame frame = i == 5 ? doors.sequence.render_dark(i) : doors.sequence.render(i);
    const TrackResult result = doors.odometry.track(frame);
    const plvo_frame c = c_frame(frame);
    plvo_result c_result = {};
    c_result.struct_size = sizeof c_result;
    const plvo_status status = plvo_track(doors.c_odometry, &c, &c_result);
    EXPECT_EQ(static_cast<int>(result.status.code()), status.code);
    EXPECT_STREQ(result.status.message(), status.message);
    expect_same(result, c_result);
    tracked += c_result.state == PLVO_TRACKING ? 1 : 0;
  }
  return tracked;
}

TEST(CApi, GivesTheBitsOfCpp) {
  Doors doors;
  EXPECT_GE(tracked_alike(doors, 10), 7);
}

TEST(CApi, PresetsAndChoicesAreThoseOfConfig) {
  plvo_config paper;
  plvo_config_init(&paper, sizeof paper);
  paper.preset = PLVO_PRESET_PAPER;
  Doors with_paper(Config::paper(), &paper);
  EXPECT_GE(tracked_alike(with_paper, 4), 3);

  plvo_config chosen;
  plvo_config_init(&chosen, sizeof chosen);
  chosen.features = PLVO_FEATURES_POINTS;
  chosen.reference = PLVO_REFERENCE_PREVIOUS;
  chosen.seed = 7;
  Config config;
  config.features = Features::kPoints;
  config.references.policy = ReferencePolicy::kPreviousFrame;
  config.seed = 7;
  Doors with_choice(config, &chosen);
  EXPECT_GE(tracked_alike(with_choice, 4), 3);

  plvo_config window;
  plvo_config_init(&window, sizeof window);
  window.reference = PLVO_REFERENCE_WINDOW;
  config = {};
  config.references.policy = ReferencePolicy::kWindow;
  Limits limits = kLimits;
  limits.references = 3;
  Doors with_window(config, &window, limits, c_limits(limits));
  EXPECT_GE(tracked_alike(with_window, 10), 7);
}

TEST(CApi, TheTinyPresetIsThatOfConfigAndLimits) {
  plvo_config config;
  plvo_config_init(&config, sizeof config);
  config.preset = PLVO_PRESET_TINY;
  plvo_limits limits = {};
  limits.struct_size = sizeof limits;
  ASSERT_EQ(plvo_limits_of_preset(PLVO_PRESET_TINY, &limits).code, PLVO_OK);
  EXPECT_LE(plvo_required_bytes(&limits), 512U * 1024);
  Doors doors(Config::tiny(), &config, Limits::tiny(), limits);
  EXPECT_GE(tracked_alike(doors, 5), 4);
  EXPECT_LE(plvo_keypoints(doors.c_odometry, nullptr, 0), 200U);

  limits.references = 4;
  EXPECT_EQ(plvo_required_bytes(&limits), 0U);
  for (const std::int32_t preset : {PLVO_PRESET_DEFAULT, PLVO_PRESET_PAPER}) {
    ASSERT_EQ(plvo_limits_of_preset(preset, &limits).code, PLVO_OK);
    EXPECT_EQ(plvo_required_bytes(&limits), plvo_required_bytes(nullptr));
  }
}

// What a frame took is what the caller says: down by too long ones, up by quick ones.
TEST(CApi, AFrameBudgetReducesTheFeatures) {
  plvo_config c_config;
  plvo_config_init(&c_config, sizeof c_config);
  c_config.frame_budget_ns = 1000;
  c_config.budget_patience_frames = 2;
  c_config.budget_spare_share = 0.5;
  Config config;
  config.budget = {.frame_ns = 1000, .patience_frames = 2, .spare_share = 0.5};
  Doors doors(config, &c_config);
  std::vector<int> steps;
  for (int i = 0; i < 12; ++i) {
    const RgbdFrame frame = doors.sequence.render(i);
    const plvo_frame c = c_frame(frame);
    plvo_result result = {};
    result.struct_size = sizeof result;
    EXPECT_EQ(plvo_track(doors.c_odometry, &c, &result).code, PLVO_OK);
    expect_same(doors.odometry.track(frame), result);
    steps.push_back(result.feature_step);
    const std::int64_t took_ns = i < 4 ? 1001 : (i < 7 ? 501 : 499);
    doors.odometry.frame_took(took_ns);
    EXPECT_EQ(plvo_frame_took(doors.c_odometry, took_ns).code, PLVO_OK);
  }
  EXPECT_EQ(steps, (std::vector{0, 1, 1, 1, 2, 2, 2, 2, 2, 1, 1, 1}));
  EXPECT_EQ(plvo_frame_took(nullptr, 1).code, PLVO_INVALID_ARGUMENT);
}

// A struct of zeros but for what its user knew is one of a program that was written before the rest.
TEST(CApi, FieldsThatAnOlderProgramLacksHaveTheirDefaults) {
  Limits expected;
  expected.width = kLimits.width;
  expected.height = kLimits.height;
  plvo_limits shorter = c_limits(expected);
  shorter.struct_size = c::kFirstSize<plvo_limits>;
  shorter.references = shorter.line_bands = shorter.kept_keyframes = 77;  // not the library's to read
  EXPECT_EQ(plvo_required_bytes(&shorter), [&] {
    const plvo_limits whole = c_limits(expected);
    return plvo_required_bytes(&whole);
  }());
  plvo_config config;
  plvo_config_init(&config, sizeof config);
  config.struct_size = c::kFirstSize<plvo_config>;
  config.frame_budget_ns = -7;
  Doors doors({}, &config, expected, shorter);
  EXPECT_GE(tracked_alike(doors, 4), 3);

  plvo_limits zeros = {};
  zeros.struct_size = sizeof zeros;
  zeros.width = zeros.height = 240;
  zeros.keypoints = zeros.segments = 100;
  expected = {240, 240, 100, 100, Limits().references, Limits().line_bands, 0, Limits().cores, 0};
  const plvo_limits whole = c_limits(expected);
  EXPECT_EQ(plvo_required_bytes(&zeros), plvo_required_bytes(&whole));
  plvo_config unset = {};
  unset.struct_size = sizeof unset;
  unset.seed = Config().seed;
  Doors with_zeros({}, &unset);
  EXPECT_GE(tracked_alike(with_zeros, 4), 3);
}

TEST(CApi, TheBlockMayStartAnywhere) {
  Doors doors({}, nullptr, 13);
  EXPECT_GE(tracked_alike(doors, 4), 3);
}

TEST(CApi, FeaturesEqualThoseOfCpp) {
  Doors doors;
  EXPECT_EQ(plvo_image(doors.c_odometry, nullptr), nullptr) << "no frame yet";
  EXPECT_EQ(plvo_keypoints(doors.c_odometry, nullptr, 0), 0U);
  tracked_alike(doors, 2);
  const FeatureView view = doors.odometry.features();

  std::vector<plvo_pixel> keypoints(plvo_keypoints(doors.c_odometry, nullptr, 0));
  ASSERT_EQ(keypoints.size(), view.keypoints.size());
  ASSERT_GT(keypoints.size(), 10U);
  plvo_keypoints(doors.c_odometry, keypoints.data(), keypoints.size());
  for (std::size_t i = 0; i < keypoints.size(); ++i) {
    EXPECT_EQ(keypoints[i].u, view.keypoints[i].u);
    EXPECT_EQ(keypoints[i].v, view.keypoints[i].v);
  }
  std::vector<plvo_point_track> tracks(plvo_point_tracks(doors.c_odometry, nullptr, 0));
  ASSERT_EQ(tracks.size(), view.point_tracks.size());
  ASSERT_GT(tracks.size(), 10U);
  plvo_point_tracks(doors.c_odometry, tracks.data(), tracks.size());
  EXPECT_EQ(tracks.back().reference.v, view.point_tracks.back().v_reference);
  EXPECT_EQ(tracks.back().current.u, view.point_tracks.back().u);
  std::vector<plvo_segment> segments(plvo_segments(doors.c_odometry, nullptr, 0));
  ASSERT_EQ(segments.size(), view.segments.size());
  ASSERT_GT(segments.size(), 2U);
  plvo_segment first[2] = {};
  EXPECT_EQ(plvo_segments(doors.c_odometry, first, 1), segments.size())
      << "no more than the capacity is written";
  EXPECT_EQ(first[0].b.v, view.segments[0].b_v);
  EXPECT_EQ(first[1].b.v, 0);
  EXPECT_EQ(plvo_reference_segments(doors.c_odometry, nullptr, 0), view.reference_segments.size());
  std::vector<plvo_line_track> lines(plvo_line_tracks(doors.c_odometry, nullptr, 0));
  ASSERT_EQ(lines.size(), view.line_tracks.size());
  ASSERT_GT(lines.size(), 0U);
  plvo_line_tracks(doors.c_odometry, lines.data(), lines.size());
  EXPECT_EQ(lines.back().current, view.line_tracks.back().current);

  std::int64_t stride = 0;
  const std::uint8_t* image = plvo_image(doors.c_odometry, &stride);
  ASSERT_NE(image, nullptr);
  EXPECT_EQ(image[100 * stride + 7], view.image.at(7, 100));
}

TEST(CApi, TakesNoMemory) {
  if (!AllocationGuard::available()) GTEST_SKIP() << "SKIPPED: a sanitizer owns malloc here";
  Doors doors;
  for (int i = 0; i < 4; ++i) {
    const plvo_frame frame = c_frame(doors.sequence.render(i));
    plvo_result result = {};
    result.struct_size = sizeof result;
    AllocationGuard guard;
    guard.arm();
    const plvo_status status = plvo_track(doors.c_odometry, &frame, &result);
    guard.disarm();
    EXPECT_EQ(status.code, PLVO_OK) << status.message;
    EXPECT_EQ(guard.calls(), 0);
  }
}

TEST(CApi, SaysHowManyBytesAreMissing) {
  const plvo_limits limits = c_limits(kLimits);
  const plvo_camera camera = c_camera(ProceduralSequence(kLimits.width, kLimits.height).camera());
  const std::size_t needed = plvo_required_bytes(&limits);
  std::vector<std::byte> memory(needed - 1);
  plvo_odometry* odometry = reinterpret_cast<plvo_odometry*>(&memory);
  const plvo_status status = plvo_init(memory.data(), memory.size(), &camera, nullptr, &limits, &odometry);
  EXPECT_EQ(status.code, PLVO_OUT_OF_MEMORY);
  EXPECT_NE(std::string(status.message).find(std::to_string(needed)), std::string::npos) << status.message;
  EXPECT_EQ(odometry, nullptr);
}

TEST(CApi, RefusesInvalidArguments) {
  const plvo_limits limits = c_limits(kLimits);
  ProceduralSequence sequence(kLimits.width, kLimits.height);
  const plvo_camera camera = c_camera(sequence.camera());
  std::vector<std::byte> memory(plvo_required_bytes(&limits));
  plvo_odometry* odometry = nullptr;
  const auto init = [&](const plvo_camera* with, const plvo_config* config, const plvo_limits* within) {
    return plvo_init(memory.data(), memory.size(), with, config, within, &odometry);
  };
  const auto says = [](const plvo_status& status, const char* words) {
    EXPECT_EQ(status.code, PLVO_INVALID_ARGUMENT);
    EXPECT_NE(std::strstr(status.message, words), nullptr) << status.message;
  };
  says(init(nullptr, nullptr, &limits), "camera is NULL");
  says(plvo_init(nullptr, 0, &camera, nullptr, &limits, &odometry), "memory is NULL");
  says(plvo_init(memory.data(), memory.size(), &camera, nullptr, &limits, nullptr), "odometry is NULL");
  plvo_camera broken = camera;
  broken.fx = -1;
  says(init(&broken, nullptr, &limits), "fx");
  plvo_config config;
  plvo_config_init(&config, sizeof config);
  config.features = 4;
  says(init(&camera, &config, &limits), "features");
  plvo_config_init(&config, sizeof config);
  config.reference = -1;
  says(init(&camera, &config, &limits), "reference");
  plvo_config_init(&config, sizeof config);
  config.preset = 3;
  says(init(&camera, &config, &limits), "preset");
  plvo_config_init(&config, sizeof config);
  config.frame_budget_ns = -1;
  says(init(&camera, &config, &limits), "budget.frame_ns");
  plvo_limits of_preset = limits;
  says(plvo_limits_of_preset(3, &of_preset), "preset");
  says(plvo_limits_of_preset(PLVO_PRESET_TINY, nullptr), "limits is NULL");
  of_preset.struct_size = 0;
  says(plvo_limits_of_preset(PLVO_PRESET_TINY, &of_preset), "struct_size");
  plvo_limits wild = limits;
  wild.keypoints = std::numeric_limits<std::int32_t>::max();
  says(init(&camera, nullptr, &wild), "keypoints");
  EXPECT_EQ(plvo_required_bytes(&wild), 0U);

  plvo_result result = {};
  result.struct_size = sizeof result;
  says(plvo_track(nullptr, nullptr, &result), "plvo_init");
  ASSERT_EQ(init(&camera, nullptr, &limits).code, PLVO_OK);
  says(plvo_track(odometry, nullptr, &result), "frame is NULL");
  says(plvo_track(odometry, nullptr, nullptr), "result is NULL");
  plvo_frame frame = c_frame(sequence.render(0));
  frame.colour_format = 9;
  says(plvo_track(odometry, &frame, &result), "colour_format");
  frame = c_frame(sequence.render(0));
  frame.depth_stride_bytes += 1;
  says(plvo_track(odometry, &frame, &result), "multiples of 2");
  frame = c_frame(sequence.render(0));
  frame.colour_stride_bytes = -frame.colour_stride_bytes;
  says(plvo_track(odometry, &frame, &result), "stride");
  EXPECT_EQ(result.state, PLVO_LOST);
}

TEST(CApi, StructSizesTellTheVersionOfTheHeader) {
  const plvo_limits limits = c_limits(kLimits);
  plvo_camera camera = c_camera(CameraModel());
  EXPECT_EQ(c::kFirstSize<plvo_camera>, 112U) << "of version 0.1, as programs were compiled then";
  std::vector<std::byte> memory(plvo_required_bytes(&limits));
  plvo_odometry* odometry = nullptr;
  camera.struct_size = 0;
  plvo_status status = plvo_init(memory.data(), memory.size(), &camera, nullptr, &limits, &odometry);
  EXPECT_STREQ(status.message, "camera.struct_size is 0; set it to sizeof(plvo_camera)");
  camera.struct_size = sizeof camera + 8;
  status = plvo_init(memory.data(), memory.size(), &camera, nullptr, &limits, &odometry);
  EXPECT_NE(std::strstr(status.message, "compiled for a newer plvo"), nullptr) << status.message;
  // A program of version 0.1 has plumb_bob, whatever lies behind its struct.
  camera = c_camera(ProceduralSequence(kLimits.width, kLimits.height).camera());
  camera.struct_size = static_cast<std::uint32_t>(c::kFirstSize<plvo_camera>);
  camera.lens = 77;
  status = plvo_init(memory.data(), memory.size(), &camera, nullptr, &limits, &odometry);
  EXPECT_EQ(status.code, PLVO_OK) << status.message;
  plvo_config config;
  plvo_config_init(&config, 4);
  EXPECT_EQ(config.struct_size, 4U) << "nothing is written past what the caller says there is";
}

TEST(CApi, StampSigmaGivesTheCovariancesOfCpp) {
  CameraModel model;
  model.stamp_sigma_s = 0.002;
  plvo_camera camera = c_camera(model);
  EXPECT_EQ(camera.stamp_sigma_s, 0.002);
  CameraModel back;
  ASSERT_TRUE(c::take_camera(&camera, back).ok());
  EXPECT_EQ(back.stamp_sigma_s, 0.002);
  // A program that was compiled before there was such a thing has exact stamps, whatever lies behind.
  camera.struct_size = static_cast<std::uint32_t>(offsetof(plvo_camera, stamp_sigma_s));
  camera.stamp_sigma_s = 77;
  const plvo_limits limits = c_limits(kLimits);
  std::vector<std::byte> memory(plvo_required_bytes(&limits));
  plvo_odometry* odometry = nullptr;
  camera.width = kLimits.width;
  camera.height = kLimits.height;
  camera.cx = kLimits.width / 2.0;
  camera.cy = kLimits.height / 2.0;
  const plvo_status status = plvo_init(memory.data(), memory.size(), &camera, nullptr, &limits, &odometry);
  EXPECT_EQ(status.code, PLVO_OK) << status.message;
}

TEST(CApi, LensesGiveTheBitsOfCpp) {
  const plvo_limits limits = c_limits(kLimits);
  std::vector<std::byte> memory(plvo_required_bytes(&limits));
  plvo_odometry* odometry = nullptr;
  const auto init = [&](const plvo_camera& camera) {
    return plvo_init(memory.data(), memory.size(), &camera, nullptr, &limits, &odometry);
  };
  CameraModel model = ProceduralSequence(kLimits.width, kLimits.height).camera();
  model.distortion = {.k1 = 0.1, .k2 = 0.2, .k3 = 0.1 * 3, .k4 = 0.4, .model = LensModel::kEquidistant};
  plvo_camera camera = c_camera(model);
  EXPECT_EQ(camera.lens, PLVO_LENS_EQUIDISTANT);
  for (int i = 0; i < 4; ++i) EXPECT_EQ(camera.distortion[i], 0.1 * (i + 1)) << "ROS's order";
  CameraModel back;
  ASSERT_TRUE(c::take_camera(&camera, back).ok());
  EXPECT_TRUE(back.distortion.k1 == 0.1 && back.distortion.k2 == 0.2 && back.distortion.k3 == 0.1 * 3 &&
              back.distortion.k4 == 0.4 && back.distortion.model == LensModel::kEquidistant);
  EXPECT_EQ(init(camera).code, PLVO_OK) << init(camera).message;
  camera.distortion[0] = -5;
  EXPECT_NE(std::strstr(init(camera).message, "equidistant distortion folds"), nullptr)
      << init(camera).message;
  camera.distortion[4] = 1;
  EXPECT_NE(std::strstr(init(camera).message, "the others must be 0"), nullptr) << init(camera).message;
  camera.lens = 2;
  EXPECT_NE(std::strstr(init(camera).message, "camera.lens must be"), nullptr) << init(camera).message;

  model.distortion = {1, 2, 3, 4, 5, 6, 7, 8};
  camera = c_camera(model);
  ASSERT_TRUE(c::take_camera(&camera, back).ok());
  EXPECT_EQ(camera.distortion_more[2], 8);
  EXPECT_TRUE(back.distortion.p1 == 3 && back.distortion.k3 == 5 && back.distortion.k4 == 6 &&
              back.distortion.k6 == 8 && back.distortion.model == LensModel::kRational);
}

TEST(CApi, APriorAndSetPoseGiveTheBitsOfCpp) {
  ProceduralSequence sequence(kLimits.width, kLimits.height);
  std::vector<std::byte> cpp_memory(required_bytes(kLimits));
  Odometry odometry;
  ASSERT_TRUE(odometry.init(cpp_memory, sequence.camera(), {}, kLimits).ok());
  const plvo_camera camera = c_camera(sequence.camera());
  const plvo_limits limits = c_limits(kLimits);
  std::vector<std::byte> memory(plvo_required_bytes(&limits));
  plvo_odometry* c = nullptr;
  ASSERT_EQ(plvo_init(memory.data(), memory.size(), &camera, nullptr, &limits, &c).code, PLVO_OK);
  const auto same = [&](const TrackResult& expected, const plvo_result& result) {
    EXPECT_EQ(static_cast<int>(expected.state), result.state);
    expect_same(expected.T_world_camera, result.T_world_camera);
    expect_same(expected.pose_covariance, result.pose_covariance);
    expect_same(expected.motion_covariance, result.motion_covariance);
  };
  const Se3 start{rotation_exp({0.1, 0.2, 0.3}), {1, 2, 3}};
  const Matrix6 covariance = 1e-4 * Matrix6::Identity();
  double T[12], C[36];
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 4; ++column)
      T[4 * row + column] = column < 3 ? start.R(row, column) : start.t(row);
  for (int i = 0; i < 36; ++i) C[i] = covariance(i / 6, i % 6);
  ASSERT_TRUE(odometry.set_pose(start, covariance).ok());
  ASSERT_EQ(plvo_set_pose(c, T, C).code, PLVO_OK);
  plvo_result result = {};
  result.struct_size = sizeof result;
  for (int i = 0; i < 7; ++i) {
    MotionPrior prior;
    plvo_prior c_prior;
    plvo_prior_init(&c_prior, sizeof c_prior);
    const Se3 T_now_before =
        i == 0 ? Se3()
               : ProceduralSequence::T_world_camera(i).inverse() * ProceduralSequence::T_world_camera(i - 1);
    prior.rotation = {T_now_before.R, 1e-6 * Matrix3::Identity()};
    prior.translation = {T_now_before.t, 1e-4 * Matrix3::Identity()};
    prior.gravity = {{0.1, 1, 0.2}, 1e-2 * Matrix3::Identity(), 0.01};
    c_prior.has_rotation = c_prior.has_translation = c_prior.has_gravity = 1;
    for (int k = 0; k < 9; ++k) {
      c_prior.R_now_before[k] = T_now_before.R(k / 3, k % 3);
      c_prior.rotation_covariance[k] = prior.rotation->covariance(k / 3, k % 3);
      c_prior.translation_covariance[k] = prior.translation->covariance(k / 3, k % 3);
      c_prior.gravity_covariance[k] = prior.gravity->covariance(k / 3, k % 3);
    }
    for (int k = 0; k < 3; ++k) {
      c_prior.t_now_before[k] = T_now_before.t(k);
      c_prior.down[k] = prior.gravity->down(k);
    }
    c_prior.gravity_offset_sigma = 0.01;
    const RgbdFrame frame = i == 5 ? sequence.render_dark(i) : sequence.render(i);
    const plvo_frame view = c_frame(frame);
    const plvo_status status = plvo_track_with_prior(c, &view, &c_prior, &result);
    EXPECT_EQ(result.state, i == 0 ? PLVO_INITIALISING : (i == 5 ? PLVO_PREDICTED : PLVO_TRACKING)) << i;
    EXPECT_EQ(status.code, i == 5 ? PLVO_TOO_FEW_FEATURES : PLVO_OK) << status.message;
    same(odometry.track(frame, prior), result);
    // A bad one is refused, and changes nothing.
    c_prior.down[1] = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(plvo_track_with_prior(c, &view, &c_prior, &result).code, PLVO_INVALID_ARGUMENT);
  }
  ASSERT_EQ(plvo_reset(c).code, PLVO_OK);
  odometry.reset();
  for (int i = 0; i < 3; ++i) {
    const RgbdFrame frame = sequence.render(i);
    const plvo_frame view = c_frame(frame);
    EXPECT_EQ(plvo_track(c, &view, &result).code, PLVO_OK);
    same(odometry.track(frame), result);
  }
  T[0] = 7;
  EXPECT_EQ(plvo_set_pose(c, T, C).code, PLVO_INVALID_ARGUMENT);
  EXPECT_EQ(plvo_set_pose(c, nullptr, C).code, PLVO_INVALID_ARGUMENT);
  EXPECT_EQ(plvo_set_pose(nullptr, T, C).code, PLVO_INVALID_ARGUMENT);
  EXPECT_EQ(plvo_reset(nullptr).code, PLVO_INVALID_ARGUMENT);
}

TEST(CApi, NamesEveryCodeAndState) {
  EXPECT_STREQ(plvo_status_name(PLVO_OK), "ok");
  EXPECT_STREQ(plvo_status_name(PLVO_NOT_CONVERGED), "not_converged");
  EXPECT_STREQ(plvo_status_name(PLVO_NOT_CONVERGED + 1), "unknown");
  EXPECT_STREQ(plvo_status_name(-1), "unknown");
  for (int code = PLVO_OK; code <= PLVO_NOT_CONVERGED; ++code)
    EXPECT_STRNE(plvo_status_name(code), "unknown");
  EXPECT_STREQ(plvo_state_name(PLVO_LOST), "lost");
  EXPECT_STREQ(plvo_state_name(PLVO_PREDICTED), "predicted");
  EXPECT_STREQ(plvo_state_name(4), "unknown");
  EXPECT_STREQ(plvo_version(), PLVO_VERSION);
}

TEST(CApi, ReturnsTheQuaternionOfARotation) {
  const double quarter_turn_about_z[12] = {0, -1, 0, 5, 1, 0, 0, 6, 0, 0, 1, 7};
  double q[4];
  plvo_quaternion(quarter_turn_about_z, q);
  EXPECT_NEAR(q[2], 0.70710678118654752, 1e-15);
  EXPECT_NEAR(q[3], 0.70710678118654752, 1e-15);
  EXPECT_EQ(q[0], 0);
}

}  // namespace
}  // namespace plvo
