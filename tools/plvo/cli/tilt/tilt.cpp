// SPDX-License-Identifier: Apache-2.0
// plvo tilt: the Kinect v1's motor, light and accelerometer.
#include <fmt/format.h>

#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "plvo/cli/common/exit_code.hpp"
#include "plvo/cli/common/interrupt.hpp"
#include "plvo/cli/common/subcommands.hpp"
#include "plvo/cli/live/live_camera.hpp"
#include "plvo/host/posix_clock.hpp"
#include "plvo/usb/kinect_motor.hpp"

namespace plvo::cli {
namespace {

constexpr double kRadPerDegree = 3.14159265358979323846 / 180;
constexpr const char* kHelp =
    "Examples:\n"
    "  plvo tilt                       where the head stands, and which way is down\n"
    "  plvo tilt -10                   look 10 degrees down\n"
    "  plvo tilt 0 --led blink-green   level, and say hello\n"
    "\n";

struct TiltOptions {
  std::optional<double> angle_deg;
  std::optional<KinectLight> light;
  bool json = false;
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

void print(const KinectState& state, bool json) {
  const double angle_deg = state.tilt_rad / kRadPerDegree;
  const Vector3& a = state.acceleration;
  if (json) {
    const nlohmann::ordered_json out = {{"tilt_deg", angle_deg},
                                        {"moving", state.moving},
                                        {"at_limit", state.at_limit},
                                        {"acceleration_m_per_s2", {a.x(), a.y(), a.z()}}};
    fmt::print("{}\n", out.dump());
    return;
  }
  fmt::print("tilt          {:+.1f} degrees against the horizon{}\n", angle_deg,
             state.moving     ? ", moving"
             : state.at_limit ? ", at its limit"
                              : "");
  fmt::print("acceleration  {:+.2f} {:+.2f} {:+.2f} m/s2 (x right, y up, z forward; at rest: gravity)\n",
             a.x(), a.y(), a.z());
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
  if (options.angle_deg && std::abs(*options.angle_deg * kRadPerDegree) > KinectMotor::kMaxTiltRad + 1e-9)
    warn("the head turns by 31 degrees at most");
  if (options.light) status = motor.set_light(*options.light);
  if (status.ok()) status = options.angle_deg ? move(motor, *options.angle_deg, state) : motor.read(state);
  if (!status.ok()) {
    fail(status);
    return exit_code_of_camera(status, {});
  }
  print(state, options.json);
  return kExitSuccess;
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
  CLI::App* command = app.add_subcommand("tilt", "A Kinect v1's motor, light and accelerometer");
  command
      ->add_option("angle", options->angle_deg,
                   "Turn the head to this angle against the horizon, up positive, -31 to 31")
      ->type_name("DEGREES");
  const std::map<std::string, KinectLight> lights = {{"off", KinectLight::kOff},
                                                     {"green", KinectLight::kGreen},
                                                     {"red", KinectLight::kRed},
                                                     {"yellow", KinectLight::kYellow},
                                                     {"blink-green", KinectLight::kBlinkGreen},
                                                     {"blink-red-yellow", KinectLight::kBlinkRedYellow}};
  command->add_option("--led", options->light, "off, green, red, yellow, blink-green or blink-red-yellow")
      ->transform(CLI::CheckedTransformer(lights).description(""))
      ->type_name("LIGHT");
  command->add_flag("--json", options->json, "One line of JSON for machines");
  command->footer(std::string(kHelp) + kExitCodeHelp);
  command->callback([options, &exit_code] { exit_code = tilt_command(*options); });
}

}  // namespace plvo::cli
