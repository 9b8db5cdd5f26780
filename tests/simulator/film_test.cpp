// SPDX-License-Identifier: Apache-2.0
// The film: its exposure settles on a mid gray, lags behind a change of light, and a moving camera blurs
// along the motion and no farther.
#include <algorithm>
#include <cmath>

#include "plvo/simulator/sensor/film.hpp"
#include "simulator_support.hpp"

namespace plvo {
namespace {

using sim::Film;
using sim::Renderer;
using sim::Rgb;

constexpr double kFrame_s = 1.0 / 30;

struct Darkroom {
  Darkroom() : scene(sim::build_scene(SceneName::kBare, 1)) {
    camera = test::small_options(SceneName::kBare).camera;
    renderer = std::make_unique<Renderer>(*scene, camera, 1);
    Se3 T_world_camera;
    T_world_camera.R << 0, 0, 1, -1, 0, 0, 0, -1, 0;
    T_world_camera.t = Vector3(2, 2.5, 1.4);
    renderer->render(std::vector<Se3>(static_cast<std::size_t>(camera.height), T_world_camera), {});
  }
  void fill(float radiance) {
    const auto view = renderer->radiance();
    std::fill(view.data, view.data + view.width * view.height, Rgb{radiance, radiance, radiance});
  }
  double mean(const Film& film) const {
    double sum = 0;
    const int n = camera.width * camera.height * 3;
    for (int i = 0; i < n; ++i) sum += film.pixels()[i];
    return sum / n;
  }

  std::unique_ptr<sim::Scene> scene;
  CameraModel camera;
  std::unique_ptr<Renderer> renderer;
};

void develop(Film& film, Renderer& renderer, const Se3& T_mid_begin, const Se3& T_mid_end,
             std::uint32_t frame) {
  film.blur(renderer, T_mid_begin, T_mid_end);
  film.expose(frame, kFrame_s);
}

TEST(Film, ExposureSettlesOnGrayAndLagsBehindTheLight) {
  Darkroom room;
  Film film(room.camera, 1, false, 1);
  room.fill(0.5F);
  std::uint32_t frame = 0;
  develop(film, *room.renderer, {}, {}, frame++);
  EXPECT_NEAR(room.mean(film), 121, 2);
  // Twice the light: at once the picture is bright, within two seconds it is gray again.
  room.fill(1.0F);
  develop(film, *room.renderer, {}, {}, frame++);
  EXPECT_GT(room.mean(film), 155);
  double last = room.mean(film);
  for (int k = 0; k < 60; ++k) {
    develop(film, *room.renderer, {}, {}, frame++);
    EXPECT_LE(room.mean(film), last);
    last = room.mean(film);
  }
  EXPECT_NEAR(last, 121, 2);
}

TEST(Film, ShutterStaysOpenLongerInTheDarkWithinItsLimits) {
  Darkroom room;
  Film film(room.camera, 1, false, 1);
  const double bright_s = film.exposure_s();
  room.fill(0.1F);
  develop(film, *room.renderer, {}, {}, 0);
  develop(film, *room.renderer, {}, {}, 1);
  EXPECT_GT(film.exposure_s(), bright_s);
  EXPECT_LT(film.exposure_s(), kFrame_s);
}

TEST(Film, NoiseHasNoBiasAndGrowsInTheDark) {
  double quiet = 0;
  for (const float radiance : {1.0F, 0.03F}) {
    Darkroom room;
    room.fill(radiance);
    Film film(room.camera, 1, true, 1);
    develop(film, *room.renderer, {}, {}, 0);
    const double mean = room.mean(film);
    EXPECT_NEAR(mean, 121, 2);
    double squares = 0;
    const int n = room.camera.width * room.camera.height * 3;
    for (int i = 0; i < n; ++i) squares += (film.pixels()[i] - mean) * (film.pixels()[i] - mean);
    const double sigma = std::sqrt(squares / n);
    if (quiet == 0) quiet = sigma;
    EXPECT_GT(sigma, 0.5);
    EXPECT_LT(sigma, 12);
    EXPECT_GE(sigma, quiet);
  }
}

TEST(Film, MotionBlursAlongTheMotionAndNoFarther) {
  Darkroom room;
  // One bright column.
  room.fill(0.1F);
  const auto view = room.renderer->radiance();
  for (int y = 0; y < view.height; ++y) view.at(80, y) = {2, 2, 2};
  const auto width = [&](double yaw) {
    Film film(room.camera, 1, true, 1);
    // Half of the turn before the middle of the exposure, half after it.
    develop(film, *room.renderer, {rotation_exp(Vector3(0, -yaw / 2, 0)), Vector3::Zero()},
            {rotation_exp(Vector3(0, yaw / 2, 0)), Vector3::Zero()}, 0);
    const std::uint8_t* row = film.pixels() + 60 * room.camera.width * 3;
    int bright = 0;
    for (int x = 40; x < 120; ++x) bright += row[3 * x + 1] > row[3 * 20 + 1] + 25;
    return bright;
  };
  EXPECT_EQ(width(0), 1);
  const int blurred = width(6.0 / room.camera.pinhole.fx);  // six pixels
  EXPECT_GE(blurred, 5);
  EXPECT_LE(blurred, 8);
}

}  // namespace
}  // namespace plvo
