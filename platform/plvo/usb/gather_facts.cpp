// SPDX-License-Identifier: Apache-2.0
// Gathers facts from libusb, sysfs and the folder of OpenNI2's drivers. diagnosis.hpp judges them.
#include <dlfcn.h>
#include <libusb.h>
#include <link.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "plvo/usb/facts.hpp"
#include "plvo/usb/usb_bus.hpp"

namespace plvo {
namespace {

namespace fs = std::filesystem;

constexpr const char* kRuleName = "60-plvo-rgbd.rules";

std::string bound_driver(const std::string& port) {
  std::error_code error;
  const fs::path link = fs::read_symlink("/sys/bus/usb/devices/" + port + ":1.0/driver", error);
  return error ? std::string() : link.filename().string();
}

long read_number(const char* path) {
  std::ifstream file(path);
  long value = -1;
  return (file >> value) ? value : -1;
}

UsbAccess to_access(int error) {
  switch (error) {
    case 0: return UsbAccess::kFree;
    case LIBUSB_ERROR_ACCESS: return UsbAccess::kDenied;
    case LIBUSB_ERROR_BUSY: return UsbAccess::kBusy;
    case LIBUSB_ERROR_NO_DEVICE: return UsbAccess::kGone;
    default: return UsbAccess::kFailed;
  }
}

// Opens the device, claims its first interface without detaching a kernel driver, and releases it.
int try_device(libusb_device* device, bool kernel_holds_it) {
  libusb_device_handle* handle = nullptr;
  int error = libusb_open(device, &handle);
  if (error != 0) return error;
  if (!kernel_holds_it) {
    error = libusb_claim_interface(handle, 0);
    if (error == 0) libusb_release_interface(handle, 0);
  }
  libusb_close(handle);
  return error;
}

void try_access(UsbBus& bus, UsbDeviceFacts& facts) {
  libusb_device** devices = nullptr;
  const ssize_t count = libusb_get_device_list(bus.context(), &devices);
  facts.access = UsbAccess::kGone;
  for (ssize_t i = 0; i < count; ++i) {
    if (libusb_get_bus_number(devices[i]) != facts.bus ||
        libusb_get_device_address(devices[i]) != facts.address) {
      continue;
    }
    const int error = try_device(devices[i], !facts.kernel_driver.empty());
    facts.access = to_access(error);
    if (facts.access == UsbAccess::kFailed) facts.access_error = libusb_strerror(error);
  }
  if (devices != nullptr) libusb_free_device_list(devices, 1);
}

// "Repository" in the section [Drivers] of the ini file; empty if it is not set.
std::string repository_setting() {
  std::ifstream ini("/etc/openni2/OpenNI.ini");
  std::string section;
  for (std::string line; std::getline(ini, line);) {
    std::erase_if(line, [](char c) { return c == ' ' || c == '\t' || c == '\r'; });
    if (line.starts_with('[')) section = line;
    if (section == "[Drivers]" && line.starts_with("Repository=")) return line.substr(11);
  }
  return {};
}

std::string find_rule() {
  for (const char* folder : {"/etc/udev/rules.d", "/usr/local/lib/udev/rules.d", "/run/udev/rules.d",
                             "/usr/lib/udev/rules.d", "/lib/udev/rules.d"}) {
    std::error_code error;
    const fs::path path = fs::path(folder) / kRuleName;
    if (fs::exists(path, error)) return path.string();
  }
  return {};
}

}  // namespace

OpenniFacts gather_openni(const std::string& library) {
  OpenniFacts facts;
  void* handle = dlopen(library.c_str(), RTLD_LAZY | RTLD_LOCAL);
  if (handle == nullptr) {
    const char* why = dlerror();
    facts.error = why != nullptr ? why : "unknown";
    return facts;
  }
  facts.found = true;
  link_map* map = nullptr;
  fs::path folder = "OpenNI2/Drivers";
  if (const std::string setting = repository_setting(); !setting.empty()) folder = setting;
  if (dlinfo(handle, RTLD_DI_LINKMAP, &map) == 0) folder = fs::path(map->l_name).parent_path() / folder;
  facts.directory = folder.string();

  std::error_code error;
  facts.directory_exists = fs::is_directory(folder, error);
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    DriverFileFacts file;
    file.name = entry.path().filename().string();
    if (void* driver = dlopen(entry.path().c_str(), RTLD_LAZY | RTLD_LOCAL); driver != nullptr) {
      dlclose(driver);
    } else {
      const char* why = dlerror();
      file.load_error = why != nullptr ? why : "unknown";
    }
    facts.files.push_back(std::move(file));
  }
  std::sort(facts.files.begin(), facts.files.end(),
            [](const DriverFileFacts& a, const DriverFileFacts& b) { return a.name < b.name; });
  dlclose(handle);
  return facts;
}

SystemFacts gather_facts(UsbBus& bus, const GatherOptions& options) {
  SystemFacts facts;
  if (const Status status = bus.open(); !status.ok()) {
    facts.usb_works = false;
    facts.usb_error = status.message();
  }
  facts.hot_plug = libusb_has_capability(LIBUSB_CAP_HAS_HOTPLUG) != 0;
  facts.devices = bus.list();
  for (UsbDeviceFacts& device : facts.devices) {
    device.kernel_driver = bound_driver(device.port);
    if (options.try_access) try_access(bus, device);
  }
  facts.usbfs_memory_mb = read_number("/sys/module/usbcore/parameters/usbfs_memory_mb");
  facts.udev_rule = find_rule();
  if (options.openni_built_in) facts.openni = gather_openni(options.openni_library);
  facts.openni.built_in = options.openni_built_in;
  return facts;
}

}  // namespace plvo
