// SPDX-License-Identifier: Apache-2.0
// plvo tilt: the Kinect v1's motor, light and accelerometer.
#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "plvo/cli/common/exit_code.hpp"
#include "plvo/cli/common/interrupt.hpp"
#include "plvo/cli/common/result_output.hpp"
#include "plvo/cli/common/subcommands.hpp"
#include "plvo/cli/live/live_camera.hpp"
#include "plvo/cli/options/arguments.hpp"
#include "plvo/host/posix_clock.hpp"
#include "plvo/usb/kinect_motor.hpp"

namespace plvo::cli {
namespace {

constexpr double kRadPerDegree = 3.14159265358979323846 / 180;
constexpr double kMaxTilt_deg = 31;  // what the motor can do
constexpr const char* kTiltHelp =
    "Examples:\n"
    "  plvo tilt                       where the head stands, and which way is down\n"
    "  plvo tilt -10                   look 10 degrees down\n"
    "  plvo tilt 0 --led blink-green   level, and say hello\n";

struct TiltOptions {
  std::optional<double> angle_deg;
  std::optional<KinectLight> light;
  std::string json;
};

#ifdef PLVO_HAVE_USB

constexpr std::int64_t kLongestMove_ns = 10'000'000'000;  // from end to end takes about four seconds
constexpr std::int64_t kLook_ns = 100'000'000;

// Waits until the head has arrived, or stopped at its limit.
Status move(KinectMotor& motor, double angle_deg, KinectState& state) {
  if (Status status = motor.set_tilt(angle_deg * kRadPerDegree); !status.ok()) return status;
  PosixClock clock;
  const std::int64_t start = clock.monotonic_ns();
  do {
    clock.sleep_until_ns(clock.monotonic_ns() + kLook_ns);
    if (Status status = motor.read(state); !status.ok()) return status;
  } while (state.moving && !interrupted() && clock.monotonic_ns() - start < kLongestMove_ns);
  if (!state.moving) return {};
  return {StatusCode::kTimeout, "the head still moves after 10 s: is something in its way?"};
}

std::string page(const KinectState& state) {
  const Vector3& a = state.acceleration;
  return fmt::format(
      "tilt          {:+.1f} degrees against the horizon{}\n"
      "acceleration  {:+.2f} {:+.2f} {:+.2f} m/s2 (x right, y up, z forward; at rest: gravity)\n",
      state.tilt_rad / kRadPerDegree,
      state.moving     ? ", moving"
      : state.at_limit ? ", at its limit"
                       : "",
      a.x(), a.y(), a.z());
}

nlohmann::ordered_json to_json(const KinectState& state) {
  const Vector3& a = state.acceleration;
  return {{"tilt_deg", state.tilt_rad / kRadPerDegree},
          {"moving", state.moving},
          {"at_limit", state.at_limit},
          {"acceleration_m_per_s2", {a.x(), a.y(), a.z()}}};
}

int tilt_command(const TiltOptions& options) {
  catch_interrupt();
  UsbBus bus;
  KinectMotor motor;
  KinectState state;
  Status status = bus.open();
  if (status.ok()) status = motor.open(bus);
  if (!status.ok()) {
    fail(status);
    return exit_code_of_camera(status, {});
  }
  if (options.light) status = motor.set_light(*options.light);
  if (status.ok()) status = options.angle_deg ? move(motor, *options.angle_deg, state) : motor.read(state);
  if (!status.ok()) {
    fail(status);
    return exit_code_of_camera(status, {});
  }
  status = write_result(options.json, to_json(state), [&] { return page(state); });
  return status.ok() ? kExitSuccess : fail(status);
}

#else

int tilt_command(const TiltOptions&) {
  return fail(
      "this plvo was built without libusb: sudo apt install libusb-1.0-0-dev, then configure and build "
      "again");
}

#endif

}  // namespace

void add_tilt(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<TiltOptions>();
  CLI::App& command = add_command(app, "tilt", "A Kinect v1's motor, light and accelerometer", kTiltHelp);
  OptionGroup group(command);
  group.number("angle", options->angle_deg, {-kMaxTilt_deg, kMaxTilt_deg}, "DEGREES",
               "Turn the head to this angle against the horizon, up positive, from -31 to 31");
  group.choice("--led", options->light,
               Choices<KinectLight>{{"off", KinectLight::kOff},
                                    {"green", KinectLight::kGreen},
                                    {"red", KinectLight::kRed},
                                    {"yellow", KinectLight::kYellow},
                                    {"blink-green", KinectLight::kBlinkGreen},
                                    {"blink-red-yellow", KinectLight::kBlinkRedYellow}},
               "The light on the front");
  add_json_option(command, options->json);
  on_command(command, exit_code, [options] { return tilt_command(*options); });
}

}  // namespace plvo::cli
