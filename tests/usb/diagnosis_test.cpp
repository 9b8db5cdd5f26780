// SPDX-License-Identifier: Apache-2.0
// Tests the step from facts to findings: each fault alone, and that each remedy names the command to type.
#include "plvo/usb/diagnosis.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <fstream>
#include <iterator>

namespace plvo {
namespace {

UsbDeviceFacts device(std::uint16_t vendor, std::uint16_t product, std::string port, int speed = 480) {
  UsbDeviceFacts facts;
  facts.known = *find_known(vendor, product);
  facts.bcd = kKinect1414Bcd;
  facts.bus = 1;
  facts.address = 5;
  facts.port = std::move(port);
  facts.node = "/dev/bus/usb/001/005";
  facts.speed_mbps = speed;
  facts.access = UsbAccess::kFree;
  return facts;
}

SystemFacts healthy_kinect() {
  SystemFacts facts;
  facts.devices = {device(0x045e, 0x02b0, "1-1.1", 12), device(0x045e, 0x02ad, "1-1.2"),
                   device(0x045e, 0x02ae, "1-1.3")};
  facts.usbfs_memory_mb = 16;
  facts.udev_rule = "/etc/udev/rules.d/60-plvo-rgbd.rules";
  facts.openni.found = true;
  facts.openni.directory = "/usr/lib/OpenNI2/Drivers";
  facts.openni.directory_exists = true;
  facts.openni.files = {{"libFreenectDriver.so.0", ""}, {"libOniFile.so.0", ""}, {"libPS1080.so.0", ""}};
  return facts;
}

const Finding* find(const std::vector<Finding>& findings, FindingCode code) {
  const auto at =
      std::find_if(findings.begin(), findings.end(), [code](const Finding& f) { return f.code == code; });
  return at == findings.end() ? nullptr : &*at;
}

// Expects that `code` is the only problem, that its text contains `in_what` and its remedy `in_remedy`.
void expect_only(const SystemFacts& facts, FindingCode code, const std::string& in_what,
                 const std::string& in_remedy) {
  const std::vector<Finding> findings = diagnose(facts);
  const Finding* finding = find(findings, code);
  ASSERT_NE(finding, nullptr) << to_string(code);
  EXPECT_NE(finding->what.find(in_what), std::string::npos) << finding->what;
  EXPECT_NE(finding->remedy.find(in_remedy), std::string::npos) << finding->remedy;
  for (const Finding& other : findings) {
    if (other.severity == Severity::kProblem) {
      EXPECT_EQ(other.code, code) << other.what;
    }
  }
}

TEST(Diagnosis, HealthyKinectGivesOnlyReady) {
  const std::vector<Finding> findings = diagnose(healthy_kinect());
  ASSERT_EQ(findings.size(), 1u) << findings.back().what;
  EXPECT_EQ(findings[0].code, FindingCode::kReady);
  EXPECT_EQ(findings[0].what, "The Kinect v1 camera (port 1-1.3) is ready.");
}

TEST(Diagnosis, ReportsThatNothingIsPluggedIn) {
  SystemFacts facts = healthy_kinect();
  facts.devices.clear();
  expect_only(facts, FindingCode::kNothingPluggedIn, "No known RGB-D sensor", "12 V");
}

TEST(Diagnosis, MotorWithoutCameraMeansMissingTwelveVolts) {
  SystemFacts facts = healthy_kinect();
  facts.devices.resize(1);
  expect_only(facts, FindingCode::kTwelveVolts, "no 12 V supply", "power supply");
}

TEST(Diagnosis, SecondKinectWithoutPowerIsReportedNextToAHealthyOne) {
  SystemFacts facts = healthy_kinect();
  facts.devices.push_back(device(0x045e, 0x02b0, "2-4.1", 12));
  const std::vector<Finding> findings = diagnose(facts);
  ASSERT_NE(find(findings, FindingCode::kTwelveVolts), nullptr);
  EXPECT_NE(find(findings, FindingCode::kTwelveVolts)->what.find("2-4.1"), std::string::npos);
  EXPECT_NE(find(findings, FindingCode::kReady), nullptr);
}

TEST(Diagnosis, PermissionNamesTheRule) {
  SystemFacts facts = healthy_kinect();
  facts.devices[2].access = UsbAccess::kDenied;
  facts.udev_rule.clear();
  expect_only(facts, FindingCode::kPermission, "/dev/bus/usb/001/005", "60-plvo-rgbd.rules");
  EXPECT_EQ(find(diagnose(facts), FindingCode::kReady), nullptr);
  facts.udev_rule = "/etc/udev/rules.d/60-plvo-rgbd.rules";
  expect_only(facts, FindingCode::kPermission, "No permission", "gives you no access: sudo udevadm");
  // An installed and active rule admits the local user and the group.
  expect_only(facts, FindingCode::kPermission, "No permission", "usermod -aG video $USER");
}

TEST(Diagnosis, NamesWhyASensorCannotBeOpened) {
  SystemFacts facts = healthy_kinect();
  facts.devices[2].access = UsbAccess::kBusy;
  expect_only(facts, FindingCode::kBusy, "is busy", "fuser -v /dev/bus/usb/001/005");
  facts.devices[2].access = UsbAccess::kGone;
  expect_only(facts, FindingCode::kGone, "was unplugged during the check", "cable");
  facts.devices[2].access = UsbAccess::kFailed;
  facts.devices[2].access_error = "Input/Output Error";
  expect_only(facts, FindingCode::kAccessFailed, "Input/Output Error", "dmesg");
}

TEST(Diagnosis, WebcamDriverHoldsTheCamera) {
  SystemFacts facts = healthy_kinect();
  facts.devices[2].kernel_driver = "gspca_kinect";
  expect_only(facts, FindingCode::kKernelDriver, "gspca_kinect", "modprobe -r gspca_kinect");
}

TEST(Diagnosis, SoundDriverOnTheAudioDeviceIsNotAProblem) {
  SystemFacts facts = healthy_kinect();
  facts.devices[1].kernel_driver = "snd-usb-audio";
  EXPECT_EQ(diagnose(facts).size(), 1u);
}

TEST(Diagnosis, ReportsPortsThatAreTooSlow) {
  SystemFacts facts = healthy_kinect();
  facts.devices[2].speed_mbps = 12;
  expect_only(facts, FindingCode::kSlowPort, "12 Mbit/s", "USB 2 port");
  facts = healthy_kinect();
  facts.devices = {device(0x045e, 0x02c4, "1-2", 480)};
  facts.openni.files.push_back({"libfreenect2-openni2.so.0", ""});
  facts.usbfs_memory_mb = 64;
  expect_only(facts, FindingCode::kSlowPort, "needs USB 3", "blue");
}

TEST(Diagnosis, HubsOfAKinectV2AreNotCameras) {
  SystemFacts facts = healthy_kinect();
  facts.openni.files.push_back({"libfreenect2-openni2.so.0", ""});
  facts.usbfs_memory_mb = 64;
  UsbDeviceFacts slow = device(0x045e, 0x02d9, "1-2", 480), fast = device(0x045e, 0x02d9, "2-2", 5000);
  slow.kernel_driver = fast.kernel_driver = "hub";
  for (const auto camera : {std::uint16_t{0x02c4}, std::uint16_t{0x02d8}}) {
    facts.devices = {slow, fast, device(0x045e, camera, "2-2.1", 5000)};
    const std::vector<Finding> findings = diagnose(facts);
    ASSERT_EQ(findings.size(), 1u) << findings.front().what;
    EXPECT_EQ(findings.front().code, FindingCode::kReady);
  }
  facts.devices = {slow};
  expect_only(facts, FindingCode::kSlowPort, "its camera is not: it needs USB 3", "blue");
}

TEST(Diagnosis, KinectV1AndKinectV2NeedTheirOwnDrivers) {
  SystemFacts facts = healthy_kinect();
  facts.openni.files = {{"libfreenect2-openni2.so.0", ""}};
  expect_only(facts, FindingCode::kDriverMissing, "no driver for the Kinect v1", "libfreenect-dev");
  facts = healthy_kinect();
  facts.devices = {device(0x045e, 0x02c4, "1-2", 5000)};
  facts.usbfs_memory_mb = 64;
  expect_only(facts, FindingCode::kDriverMissing, "no driver for the Kinect v2", "libfreenect2");
}

TEST(Diagnosis, ReportsMissingMisnamedAndBrokenDrivers) {
  SystemFacts facts = healthy_kinect();
  facts.openni.files = {{"libPS1080.so.0", ""}};
  expect_only(facts, FindingCode::kDriverMissing, "/usr/lib/OpenNI2/Drivers", "libfreenect-dev");
  facts.openni.files = {{"libFreenectDriver.so", ""}};
  expect_only(facts, FindingCode::kDriverMisnamed, "libFreenectDriver.so",
              "sudo mv /usr/lib/OpenNI2/Drivers/libFreenectDriver.so "
              "/usr/lib/OpenNI2/Drivers/libFreenectDriver.so.0");
  facts.openni.files = {{"libFreenectDriver.so.0", "libfreenect.so.0.5: cannot open shared object file"}};
  expect_only(facts, FindingCode::kDriverBroken, "libfreenect.so.0.5", "Install the library");
  facts.devices = {device(0x2bc5, 0x0401, "1-4")};
  facts.openni.files = {{"liborbbec.so", ""}};
  expect_only(facts, FindingCode::kDriverMisnamed, "liborbbec.so", "liborbbec.so.0");
}

TEST(Diagnosis, ReportsAMissingOpenniOrDriverFolder) {
  SystemFacts facts = healthy_kinect();
  facts.openni.directory_exists = false;
  expect_only(facts, FindingCode::kDriverFolderMissing, "/usr/lib/OpenNI2/Drivers", "libopenni2-0");
  facts.openni.found = false;
  facts.openni.error = "libOpenNI2.so.0: cannot open shared object file";
  expect_only(facts, FindingCode::kOpenniMissing, "cannot open shared object", "apt install libopenni2-0");
  facts.openni.built_in = false;
  expect_only(facts, FindingCode::kOpenniNotBuilt, "without OpenNI2", "libopenni2-dev");
}

TEST(Diagnosis, NotesDoNotHideReadiness) {
  SystemFacts facts = healthy_kinect();
  facts.udev_rule.clear();
  facts.hot_plug = false;
  facts.usbfs_memory_mb = 8;
  facts.devices.push_back(device(0x1d27, 0x0601, "1-5"));
  const std::vector<Finding> findings = diagnose(facts);
  for (FindingCode code : {FindingCode::kRuleMissing, FindingCode::kNoHotPlug, FindingCode::kUsbfsMemory,
                           FindingCode::kSharedBus, FindingCode::kReady}) {
    ASSERT_NE(find(findings, code), nullptr) << to_string(code);
    EXPECT_NE(find(findings, code)->severity, Severity::kProblem);
  }
  EXPECT_NE(find(findings, FindingCode::kUsbfsMemory)->remedy.find("usbfs_memory_mb"), std::string::npos);
}

TEST(Diagnosis, ReportsThatTheUsbIsUnavailable) {
  SystemFacts facts = healthy_kinect();
  facts.devices.clear();
  facts.usb_works = false;
  facts.usb_error = "libusb cannot start: Other error";
  expect_only(facts, FindingCode::kUsbUnavailable, "Other error", "/dev/bus/usb");
}

TEST(Diagnosis, OnlyOneFileNamePatternIsADriver) {
  EXPECT_TRUE(is_driver_name("libPS1080.so.0"));
  for (const char* name :
       {"libPS1080.so", "libPS1080.so.0.1", "PS1080.so.0", "lib.so.0", "OniFile.ini", ""}) {
    EXPECT_FALSE(is_driver_name(name)) << name;
  }
}

// Sensors observe private spaces, so not every user of the machine may access them.
TEST(UdevRule, GrantsAccessToTheSeatAndTheGroupOnly) {
  std::ifstream file(PLVO_UDEV_RULE);
  int rules = 0;
  for (std::string line; std::getline(file, line);) {
    if (line.empty() || line[0] == '#' || line.find("ATTR{idVendor}") == std::string::npos) continue;
    ++rules;
    EXPECT_NE(line.find("MODE=\"0660\", GROUP=\"video\", TAG+=\"uaccess\""), std::string::npos) << line;
  }
  EXPECT_EQ(rules, 3);
}

TEST(KnownSensors, EveryIdIsUniqueAndInTheUdevRule) {
  std::ifstream file(PLVO_UDEV_RULE);
  const std::string rule((std::istreambuf_iterator<char>(file)), {});
  for (const KnownUsbDevice& known : known_usb_devices()) {
    EXPECT_EQ(find_known(known.vendor, known.product), &known) << known.name;
    std::array<char, 5> vendor{}, product{};
    std::snprintf(vendor.data(), vendor.size(), "%04x", known.vendor);
    std::snprintf(product.data(), product.size(), "%04x", known.product);
    const std::size_t line = rule.find("ATTR{idVendor}==\"" + std::string(vendor.data()));
    ASSERT_NE(line, std::string::npos) << known.name;
    EXPECT_NE(rule.substr(line, rule.find('\n', line) - line).find(product.data()), std::string::npos)
        << known.name;
  }
  EXPECT_EQ(find_known(0x1d6b, 0x0002), nullptr);  // a root hub
}

}  // namespace
}  // namespace plvo
