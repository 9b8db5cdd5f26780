// SPDX-License-Identifier: Apache-2.0
#include "plvo/cli/doctor/doctor_page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <nlohmann/json.hpp>

#include "plvo/host/printable.hpp"

namespace plvo::cli {
namespace {

constexpr std::size_t kPageWidth = 100;  // of a page, in characters

const char* word(UsbAccess access) {
  switch (access) {
    case UsbAccess::kNotTried: return "not tried";
    case UsbAccess::kFree: return "free";
    case UsbAccess::kDenied: return "no permission";
    case UsbAccess::kBusy: return "busy";
    case UsbAccess::kGone: return "gone";
    case UsbAccess::kFailed: return "failed";
  }
  return "failed";
}

const char* word(Severity severity) {
  switch (severity) {
    case Severity::kGood: return "good";
    case Severity::kNote: return "note";
    case Severity::kProblem: return "problem";
  }
  return "problem";
}

// Text in lines of the page's width, each after the first one set in by `indent`.
std::string wrapped(const std::string& text, std::size_t indent) {
  std::string out;
  std::size_t column = indent;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find(' ', at), text.size());
    if (column + (end - at) > kPageWidth && column > indent) {
      out.pop_back();  // the space before
      out += '\n' + std::string(indent, ' ');
      column = indent;
    }
    out.append(text, at, end - at);
    column += end - at + 1;
    at = end + 1;
    if (at < text.size()) out += ' ';
  }
  return out;
}

void put_row(std::string& to, const std::string& name, const std::string& value) {
  fmt::format_to(std::back_inserter(to), "  {:<18} {}\n", printable(name), wrapped(printable(value), 21));
}

// Packages bring libX.so as a link beside libX.so.0, which is the one that counts.
bool has_driver_name(const OpenniFacts& openni, const std::string& link) {
  return std::any_of(openni.files.begin(), openni.files.end(),
                     [&](const DriverFileFacts& file) { return file.name == link + ".0"; });
}

void put_system(std::string& to, const SystemFacts& facts) {
  to += "System\n";
  put_row(to, "USB",
          facts.usb_works ? facts.hot_plug ? "works, with hot-plug" : "works, without hot-plug"
                          : "does not work: " + facts.usb_error);
  put_row(to, "usbfs memory",
          facts.usbfs_memory_mb < 0    ? "not stated"
          : facts.usbfs_memory_mb == 0 ? "no limit"
                                       : fmt::format("{} MB", facts.usbfs_memory_mb));
  put_row(to, "udev rule", facts.udev_rule.empty() ? "not installed" : facts.udev_rule);
  const OpenniFacts& openni = facts.openni;
  put_row(to, "OpenNI2",
          !openni.built_in ? "not built in"
          : !openni.found  ? "does not load: " + openni.error
                           : "drivers in " + openni.directory);
  for (const DriverFileFacts& file : openni.files) {
    if (is_driver_name(file.name)) {
      put_row(to, "  driver", file.name + (file.load_error.empty() ? "" : ": does not load"));
    } else if (file.name.find(".so") != std::string::npos && !has_driver_name(openni, file.name)) {
      put_row(to, "  driver", file.name + ": OpenNI2 does not look at this name");
    }
  }
}

void put_sensors(std::string& to, const DoctorReport& report) {
  to += "\nSensors on the USB\n";
  if (report.system.devices.empty()) to += "  none that plvo knows\n";
  for (const UsbDeviceFacts& d : report.system.devices)
    put_row(to, d.known.name,
            fmt::format("port {}, {}, {}, {}{}", d.port, d.node,
                        d.speed_mbps > 0 ? fmt::format("{} Mbit/s", d.speed_mbps) : "speed not stated",
                        word(d.access),
                        d.kernel_driver.empty() ? "" : ", held by the kernel driver " + d.kernel_driver));
  to += "\nCameras of OpenNI2 (for --device)\n";
  if (report.openni_devices.empty()) to += "  none\n";
  for (const OpenNi2DeviceInfo& d : report.openni_devices)
    put_row(to, d.uri, fmt::format("{} {}", d.vendor, d.name));
}

void put_capture(std::string& to, const CaptureFacts& c) {
  if (!c.tried) return;
  to += "\nTest capture\n";
  if (!c.opened.ok()) {
    put_row(to, "not possible", c.opened.message());
    return;
  }
  put_row(to, "camera", fmt::format("{}, {}x{}@{}", c.name, c.mode.width, c.mode.height, c.mode.fps));
  put_row(to, "frames",
          fmt::format("{} in {:.1f} s, {:.1f} per second", c.counters.frames, c.seconds, c.hz()));
  put_row(to, "bandwidth", fmt::format("{:.1f} MB/s of colour and depth", c.megabytes_per_s()));
  put_row(to, "lost",
          fmt::format("{} frames by their stamps; without partner {} colour, {} depth; damaged {}",
                      c.counters.missing, c.counters.unmatched_colour, c.counters.unmatched_depth,
                      c.counters.damaged));
  put_row(to, "registration", c.registered_by_device ? "by the sensor" : "in software");
  put_row(to, "last image",
          fmt::format("mean brightness {:.0f} of 255; {:.0f} % of the pixels have depth", c.mean_brightness,
                      100 * c.depth_share));
  for (const std::string& warning : c.warnings) put_row(to, "it warns", warning);
}

void put_finding(std::string& to, Severity severity, const std::string& what, const std::string& remedy) {
  fmt::format_to(std::back_inserter(to), "  {:<8} {}\n", word(severity), wrapped(printable(what), 11));
  if (!remedy.empty())
    fmt::format_to(std::back_inserter(to), "           -> {}\n", wrapped(printable(remedy), 14));
}

nlohmann::ordered_json json_of(const CaptureFacts& c) {
  if (!c.tried) return nullptr;
  if (!c.opened.ok()) return {{"opened", false}, {"message", c.opened.message()}};
  return {{"opened", true},
          {"camera", c.name},
          {"width", c.mode.width},
          {"height", c.mode.height},
          {"seconds", c.seconds},
          {"frames", c.counters.frames},
          {"hz", c.hz()},
          {"megabytes_per_s", c.megabytes_per_s()},
          {"missing", c.counters.missing},
          {"unmatched_colour", c.counters.unmatched_colour},
          {"unmatched_depth", c.counters.unmatched_depth},
          {"damaged", c.counters.damaged},
          {"registered_by_device", c.registered_by_device},
          {"mean_brightness", c.mean_brightness},
          {"depth_share", c.depth_share},
          {"warnings", c.warnings},
          {"message", c.last.message()}};
}

}  // namespace

bool DoctorReport::healthy() const {
  if (capture.tried)
    return std::none_of(capture_findings.begin(), capture_findings.end(),
                        [](const CaptureFinding& f) { return f.severity == Severity::kProblem; });
  return std::none_of(findings.begin(), findings.end(),
                      [](const Finding& f) { return f.severity == Severity::kProblem; });
}

std::string to_text(const DoctorReport& report) {
  std::string text;
  put_system(text, report.system);
  put_sensors(text, report);
  put_capture(text, report.capture);
  text += "\nWhat it means, and what to do\n";
  for (const Finding& f : report.findings) put_finding(text, f.severity, f.what, f.remedy);
  for (const CaptureFinding& f : report.capture_findings) put_finding(text, f.severity, f.what, f.remedy);
  return text;
}

nlohmann::ordered_json to_json(const DoctorReport& report) {
  using Json = nlohmann::ordered_json;
  const SystemFacts& s = report.system;
  Json json = {{"healthy", report.healthy()},
               {"usb", {{"works", s.usb_works}, {"error", s.usb_error}, {"hot_plug", s.hot_plug}}},
               {"usbfs_memory_mb", s.usbfs_memory_mb},
               {"udev_rule", s.udev_rule}};
  json["openni2"] = {{"built_in", s.openni.built_in},
                     {"found", s.openni.found},
                     {"error", s.openni.error},
                     {"directory", s.openni.directory}};
  json["openni2"]["drivers"] = Json::array();
  for (const char* list : {"usb_devices", "cameras", "findings"}) json[list] = Json::array();
  for (const DriverFileFacts& f : s.openni.files)
    json["openni2"]["drivers"].push_back({{"name", f.name}, {"load_error", f.load_error}});
  for (const UsbDeviceFacts& d : s.devices)
    json["usb_devices"].push_back({{"name", d.known.name},
                                   {"port", d.port},
                                   {"node", d.node},
                                   {"speed_mbps", d.speed_mbps},
                                   {"access", word(d.access)},
                                   {"kernel_driver", d.kernel_driver}});
  for (const OpenNi2DeviceInfo& d : report.openni_devices)
    json["cameras"].push_back({{"uri", d.uri}, {"vendor", d.vendor}, {"name", d.name}});
  json["capture"] = json_of(report.capture);
  const auto put = [&](Severity severity, const std::string& code, const std::string& what,
                       const std::string& remedy) {
    json["findings"].push_back(
        {{"severity", word(severity)}, {"code", code}, {"what", what}, {"remedy", remedy}});
  };
  for (const Finding& f : report.findings) put(f.severity, to_string(f.code), f.what, f.remedy);
  for (const CaptureFinding& f : report.capture_findings) put(f.severity, f.code, f.what, f.remedy);
  return json;
}

}  // namespace plvo::cli
