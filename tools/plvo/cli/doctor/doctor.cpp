// SPDX-License-Identifier: Apache-2.0
// plvo doctor: one page about everything between a sensor and its pictures.
#include <fmt/format.h>
#include <unistd.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "plvo/cli/common/exit_code.hpp"
#include "plvo/cli/common/file_roles.hpp"
#include "plvo/cli/common/interrupt.hpp"
#include "plvo/cli/common/result_output.hpp"
#include "plvo/cli/common/subcommands.hpp"
#include "plvo/cli/doctor/doctor_page.hpp"
#include "plvo/cli/options/arguments.hpp"
#include "plvo/host/files/line_file.hpp"
#include "plvo/host/stderr_log.hpp"
#include "plvo/recording/recording.hpp"
#include "plvo/usb/usb_bus.hpp"

namespace plvo::cli {
namespace {

constexpr const char* kDoctorHelp =
    "Looks at the USB, permissions, OpenNI2 and its drivers, then captures for three seconds, and says\n"
    "what is wrong and what to type. Exit code 0: pictures come. 4: they do not, and the end of the page\n"
    "says why.\n";

struct DoctorOptions {
  LiveCameraOptions camera;
  double seconds = 3;
  bool no_capture = false;
  std::string json;
};

#ifdef PLVO_HAVE_USB
#ifdef PLVO_HAVE_OPENNI2
constexpr bool kOpenNi2BuiltIn = true;
#else
constexpr bool kOpenNi2BuiltIn = false;
#endif

// Nothing known on the USB, yet OpenNI2 has a camera: a network camera, a virtual one. No problem, then.
void excuse_unknown_sensors(DoctorReport& report) {
  if (report.openni_devices.empty()) return;
  for (Finding& f : report.findings) {
    if (f.code != FindingCode::kNothingPluggedIn) continue;
    f.severity = Severity::kNote;
    f.what = "No sensor on the USB is one that plvo knows, but OpenNI2 has a camera.";
    f.remedy.clear();
  }
}

int doctor_command(const DoctorOptions& options) {
  catch_interrupt();
  DoctorReport report;
  UsbBus bus;
  GatherOptions gather;
  gather.openni_built_in = kOpenNi2BuiltIn;
  report.system = gather_facts(bus, gather);
  report.findings = diagnose(report.system);
  const Status listed = list_live_cameras(report.openni_devices);
  excuse_unknown_sensors(report);
  // Without a camera the findings above already give the reason; a capture would only fail again.
  const bool has_camera = !report.openni_devices.empty() || !options.camera.device.empty();
  if (!options.no_capture && has_camera && listed.ok()) {
    if (!is_standard_output(options.json) && isatty(STDERR_FILENO) == 1)
      StderrLog().write(LogLevel::kInfo, fmt::format("capturing for {:g} s", options.seconds));
    report.capture = capture(options.camera, options.seconds);
    report.capture_findings = judge(report.capture);
  }
  if (Status status = write_result(options.json, to_json(report), [&] { return to_text(report); });
      !status.ok())
    return fail(status);
  return report.healthy() ? kExitSuccess : kExitNoSensor;
}

#else

int doctor_command(const DoctorOptions&) {
  return fail(
      "this plvo was built without libusb: sudo apt install libusb-1.0-0-dev, then configure and build "
      "again");
}

#endif

void check(const CLI::App& command, const DoctorOptions& options) {
  check_live_camera_options(command, options.camera);
  if (is_bag(options.camera.device))
    refuse("--device", "a ROS bag is not a sensor: plvo run FILE.bag tracks it");
  if (options.no_capture) {
    const char* why = "is for the capture, which --no-capture leaves out";
    refuse_options(command, {"--seconds", "--mode", "--device"}, why);
    refuse_group(command, kCalibrationGroup, why);
  }
  FileRoles files;
  files.writes("--json", options.json);
  add_inputs(options.camera, files);
  files.check();
}

}  // namespace

void add_doctor(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<DoctorOptions>();
  CLI::App& command =
      add_command(app, "doctor", "Say what is wrong with the sensor, and what to do", kDoctorHelp);
  add_live_camera_options(command, options->camera, PlayedFiles::kOni);
  OptionGroup group(command);
  group.number("--seconds", options->seconds, kSeconds, "SECONDS", "How long to capture (default 3)");
  group.flag("--no-capture", options->no_capture, "Look, but do not open the camera");
  add_json_option(command, options->json);
  on_command(command, exit_code, [&command, options] {
    check(command, *options);
    return doctor_command(*options);
  });
}

}  // namespace plvo::cli
