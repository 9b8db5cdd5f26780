// SPDX-License-Identifier: Apache-2.0
#include "plvo/usb/diagnosis.hpp"

#include <algorithm>
#include <cctype>
#include <set>

namespace plvo {
namespace {

using Findings = std::vector<Finding>;

constexpr const char* kRule = "60-plvo-rgbd.rules";
constexpr const char* kReplug =
    "sudo udevadm control --reload && sudo udevadm trigger, then plug the sensor in again";

// The rule gives access to the local user. Remote users and services need the group.
constexpr const char* kGroup = "Over ssh and for services: sudo usermod -aG video $USER, then log in again.";

std::string install_rule() {
  return std::string("sudo cmake --install build installs the udev rule ") + kRule +
         " (or: sudo cp platform/plvo/usb/" + kRule + " /etc/udev/rules.d/); after that " + kReplug + ". " +
         kGroup;
}

std::string where(const UsbDeviceFacts& device) {
  return std::string(device.known.name) + " (port " + device.port + ")";
}

// The port of the hub that a device is connected to. The three parts of one Kinect share it.
std::string hub_of(const UsbDeviceFacts& device) {
  const std::size_t cut = device.port.find_last_of(".-");
  return cut == std::string::npos ? device.port : device.port.substr(0, cut);
}

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

bool serves(SensorFamily family, const std::string& file) {
  const std::string name = lower(file);
  if (family == SensorFamily::kKinectV1) {
    const bool mark = name.find("freenect") != std::string::npos || name.find("kinect") != std::string::npos;
    return mark && name.find("freenect2") == std::string::npos && name.find("kinect2") == std::string::npos;
  }
  return name.find(needs_of(family).driver_mark) != std::string::npos;
}

void judge_power(const SystemFacts& facts, Findings& out) {
  std::set<std::string> with_camera, told;
  for (const UsbDeviceFacts& device : facts.devices) {
    if (device.known.part == SensorPart::kCamera) with_camera.insert(hub_of(device));
  }
  for (const UsbDeviceFacts& device : facts.devices) {
    const std::string hub = hub_of(device);
    if (device.known.family != SensorFamily::kKinectV1 || with_camera.count(hub) != 0 ||
        !told.insert(hub).second) {
      continue;
    }
    out.push_back(
        {Severity::kProblem, FindingCode::kTwelveVolts,
         where(device) + " is there, but its camera is not: the Kinect has no 12 V supply.",
         "Plug the Kinect's power supply in (USB alone feeds only the motor's electronics); the camera "
         "appears a second later. Powered already: try another supply, the green light must blink."});
  }
}

// Returns false if the device is not usable in its current state.
bool judge_access(const UsbDeviceFacts& device, bool rule_installed, Findings& out) {
  switch (device.access) {
    case UsbAccess::kNotTried:
    case UsbAccess::kFree: return true;
    case UsbAccess::kDenied:
      out.push_back({Severity::kProblem, FindingCode::kPermission,
                     "No permission to use the " + where(device) + ", " + device.node + ".",
                     rule_installed ? std::string("The udev rule ") + kRule +
                                          " is installed but gives you no access: " + kReplug + ". " + kGroup
                                    : install_rule()});
      return false;
    case UsbAccess::kBusy:
      out.push_back(
          {Severity::kProblem, FindingCode::kBusy,
           "The " + where(device) + " is busy: another program holds it, or one ended without releasing it.",
           "Find it with: sudo fuser -v " + device.node +
               ". End that program; if there is none, unplug the sensor and plug it in again."});
      return false;
    case UsbAccess::kGone:
      out.push_back({Severity::kProblem, FindingCode::kGone,
                     "The " + where(device) + " was unplugged during the check.",
                     "Check the cable and the 12 V plug; a sensor that comes and goes lacks power or has a "
                     "bad cable."});
      return false;
    case UsbAccess::kFailed:
      out.push_back({Severity::kProblem, FindingCode::kAccessFailed,
                     "The " + where(device) + " cannot be opened: " + device.access_error + ".",
                     "Unplug it and plug it in again, or try another port; sudo dmesg | tail shows the "
                     "kernel's view."});
      return false;
  }
  return false;
}

// The hubs of a Kinect v2 appear on any port, its camera only on USB 3.
void judge_hubs(const SystemFacts& facts, Findings& out) {
  const auto shows = [&facts](SensorPart part) {
    return std::any_of(facts.devices.begin(), facts.devices.end(), [part](const UsbDeviceFacts& device) {
      return device.known.family == SensorFamily::kKinectV2 && device.known.part == part;
    });
  };
  if (!shows(SensorPart::kHub) || shows(SensorPart::kCamera)) return;
  out.push_back(
      {Severity::kProblem, FindingCode::kSlowPort,
       "A Kinect v2 is there, but its camera is not: it needs USB 3 (5000 Mbit/s) and its power supply.",
       "Use a USB 3 port (blue) and a USB 3 cable, without a hub between, and plug the Kinect's power "
       "supply in."});
}

bool judge_speed(const UsbDeviceFacts& device, Findings& out) {
  const int needed = needs_of(device.known.family).min_speed_mbps;
  if (device.speed_mbps == 0 || device.speed_mbps >= needed) return true;
  const bool usb3 = needed > 480;
  out.push_back({Severity::kProblem, FindingCode::kSlowPort,
                 "The " + where(device) + " runs at " + std::to_string(device.speed_mbps) +
                     " Mbit/s; it needs " + (usb3 ? "USB 3 (5000 Mbit/s)." : "USB 2 (480 Mbit/s)."),
                 usb3
                     ? "Use a USB 3 port (blue) and a USB 3 cable, without a hub between."
                     : "Use a USB 2 port of the computer itself; an old hub or a long cable slows it down."});
  return false;
}

bool judge_kernel_driver(const UsbDeviceFacts& device, Findings& out) {
  if (device.kernel_driver.empty()) return true;
  const std::string& driver = device.kernel_driver;
  out.push_back({Severity::kProblem, FindingCode::kKernelDriver,
                 "The kernel driver " + driver + " holds the " + where(device) +
                     " as a webcam; depth and colour cannot both come through it.",
                 "sudo modprobe -r " + driver + "; for good: echo 'blacklist " + driver +
                     "' | sudo tee /etc/modprobe.d/plvo-" + driver + ".conf"});
  return false;
}

bool judge_driver(SensorFamily family, const OpenniFacts& openni, Findings& out) {
  const SensorNeeds& needs = needs_of(family);
  const std::string folder = openni.directory;
  for (const DriverFileFacts& file : openni.files) {
    if (!serves(family, file.name) || !is_driver_name(file.name)) continue;
    if (file.load_error.empty()) return true;
    out.push_back(
        {Severity::kProblem, FindingCode::kDriverBroken,
         "OpenNI2's driver for the " + std::string(needs.name) + ", " + file.name +
             ", does not load: " + file.load_error + ".",
         "Install the library that it misses, or the driver again. " + std::string(needs.driver_remedy)});
    return false;
  }
  for (const DriverFileFacts& file : openni.files) {
    if (!serves(family, file.name)) continue;
    const std::size_t so = file.name.find(".so");
    const std::string stem = file.name.substr(0, so);
    const std::string wanted = (stem.rfind("lib", 0) == 0 ? stem : "lib" + stem) + ".so.0";
    out.push_back({Severity::kProblem, FindingCode::kDriverMisnamed,
                   "OpenNI2's driver for the " + std::string(needs.name) +
                       " is there under a name that OpenNI2 does "
                       "not look at: " +
                       file.name + " (only lib*.so.0 is loaded).",
                   "sudo mv " + folder + "/" + file.name + " " + folder + "/" + wanted});
    return false;
  }
  out.push_back({Severity::kProblem, FindingCode::kDriverMissing,
                 "OpenNI2 has no driver for the " + std::string(needs.name) + " in " + folder + ".",
                 needs.driver_remedy});
  return false;
}

// Returns false if OpenNI2 itself is not usable.
bool judge_openni(const OpenniFacts& openni, Findings& out) {
  if (!openni.built_in) {
    out.push_back({Severity::kProblem, FindingCode::kOpenniNotBuilt, "This plvo was built without OpenNI2.",
                   "sudo apt install libopenni2-dev, then configure and build again."});
    return false;
  }
  if (!openni.found) {
    out.push_back({Severity::kProblem, FindingCode::kOpenniMissing,
                   "The OpenNI2 library cannot be loaded: " + openni.error + ".",
                   "sudo apt install libopenni2-0"});
    return false;
  }
  if (!openni.directory_exists) {
    out.push_back(
        {Severity::kProblem, FindingCode::kDriverFolderMissing,
         "OpenNI2 looks for its drivers in " + openni.directory + ", which is not there.",
         "sudo apt install --reinstall libopenni2-0; and check Repository= in /etc/openni2/OpenNI.ini."});
    return false;
  }
  return true;
}

void judge_bandwidth(const SystemFacts& facts, Findings& out) {
  int cameras = 0, usb3 = 0;
  std::multiset<int> buses;
  for (const UsbDeviceFacts& device : facts.devices) {
    if (device.known.part != SensorPart::kCamera) continue;
    ++cameras;
    if (needs_of(device.known.family).min_speed_mbps > 480) ++usb3;
    buses.insert(device.bus);
  }
  for (auto bus = buses.begin(); bus != buses.end(); bus = buses.upper_bound(*bus)) {
    if (buses.count(*bus) < 2) continue;
    out.push_back({Severity::kNote, FindingCode::kSharedBus,
                   std::to_string(buses.count(*bus)) + " sensors share USB bus " + std::to_string(*bus) +
                       "; depth and colour of one take about two thirds of a USB 2 bus.",
                   "Plug them into ports of different controllers (lsusb -t shows which is which)."});
  }
  const long needed = usb3 > 0 || cameras > 1 ? 64 : 16;
  if (cameras > 0 && facts.usbfs_memory_mb > 0 && facts.usbfs_memory_mb < needed) {
    out.push_back({Severity::kNote, FindingCode::kUsbfsMemory,
                   "The kernel lends USB programs " + std::to_string(facts.usbfs_memory_mb) + " MB; " +
                       std::to_string(needed) + " MB are needed here.",
                   "echo " + std::to_string(needed) +
                       " | sudo tee /sys/module/usbcore/parameters/usbfs_memory_mb; for good: "
                       "usbcore.usbfs_memory_mb=" +
                       std::to_string(needed) + " on the kernel's command line."});
  }
}

}  // namespace

const char* to_string(FindingCode code) {
  switch (code) {
    case FindingCode::kReady: return "ready";
    case FindingCode::kUsbUnavailable: return "usb_unavailable";
    case FindingCode::kNothingPluggedIn: return "nothing_plugged_in";
    case FindingCode::kTwelveVolts: return "twelve_volts";
    case FindingCode::kPermission: return "permission";
    case FindingCode::kBusy: return "busy";
    case FindingCode::kKernelDriver: return "kernel_driver";
    case FindingCode::kSlowPort: return "slow_port";
    case FindingCode::kSharedBus: return "shared_bus";
    case FindingCode::kUsbfsMemory: return "usbfs_memory";
    case FindingCode::kGone: return "gone";
    case FindingCode::kAccessFailed: return "access_failed";
    case FindingCode::kRuleMissing: return "rule_missing";
    case FindingCode::kNoHotPlug: return "no_hot_plug";
    case FindingCode::kOpenniNotBuilt: return "openni_not_built";
    case FindingCode::kOpenniMissing: return "openni_missing";
    case FindingCode::kDriverFolderMissing: return "driver_folder_missing";
    case FindingCode::kDriverMissing: return "driver_missing";
    case FindingCode::kDriverMisnamed: return "driver_misnamed";
    case FindingCode::kDriverBroken: return "driver_broken";
  }
  return "unknown";
}

bool is_driver_name(const std::string& name) {
  constexpr std::string_view kEnd = ".so.0";
  return name.rfind("lib", 0) == 0 && name.size() > kEnd.size() + 3 &&
         name.compare(name.size() - kEnd.size(), kEnd.size(), kEnd) == 0;
}

std::vector<Finding> diagnose(const SystemFacts& facts) {
  Findings out;
  if (!facts.usb_works) {
    out.push_back({Severity::kProblem, FindingCode::kUsbUnavailable,
                   "The USB cannot be used: " + facts.usb_error + ".",
                   "In a container: pass /dev/bus/usb in (docker run --device=/dev/bus/usb)."});
  } else if (facts.devices.empty()) {
    out.push_back({Severity::kProblem, FindingCode::kNothingPluggedIn, "No known RGB-D sensor is plugged in.",
                   "Plug a Kinect, Xtion or Astra in; a Kinect needs its 12 V supply as well. lsusb must "
                   "show it; if it "
                   "does not, try another cable and port."});
  }
  judge_power(facts, out);
  const bool openni_usable = judge_openni(facts.openni, out);
  std::set<SensorFamily> with_driver, without_driver;
  for (const UsbDeviceFacts& device : facts.devices) {
    if (device.known.part == SensorPart::kHub) continue;  // the kernel's hub driver holds it
    bool usable = judge_access(device, !facts.udev_rule.empty(), out);
    if (device.known.part != SensorPart::kCamera) continue;
    const SensorFamily family = device.known.family;
    usable = judge_speed(device, out) && usable;
    usable = judge_kernel_driver(device, out) && usable;
    if (openni_usable && with_driver.count(family) + without_driver.count(family) == 0) {
      (judge_driver(family, facts.openni, out) ? with_driver : without_driver).insert(family);
    }
    if (usable && with_driver.count(family) != 0) {
      out.push_back({Severity::kGood, FindingCode::kReady, "The " + where(device) + " is ready.", ""});
    }
  }
  judge_hubs(facts, out);
  judge_bandwidth(facts, out);
  if (!facts.devices.empty() && facts.udev_rule.empty() &&
      std::none_of(out.begin(), out.end(),
                   [](const Finding& f) { return f.code == FindingCode::kPermission; })) {
    out.push_back({Severity::kNote, FindingCode::kRuleMissing,
                   std::string("The udev rule ") + kRule +
                       " is not installed; it works now, but perhaps only for this "
                       "user.",
                   install_rule()});
  }
  if (facts.usb_works && !facts.hot_plug) {
    out.push_back({Severity::kNote, FindingCode::kNoHotPlug,
                   "This system does not report when a USB device comes or goes; an unplugged Kinect shows "
                   "as a timeout.",
                   "Run a udev daemon (in a container: share /run/udev with the host)."});
  }
  return out;
}

}  // namespace plvo
