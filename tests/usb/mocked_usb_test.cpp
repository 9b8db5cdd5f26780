// SPDX-License-Identifier: Apache-2.0
// The real libusb with simulated devices: the doctor's four cases, the Kinect's motor, and hot-plug. Runs
// under umockdev-wrapper.
#include <gtest/gtest.h>
#include <sys/fsuid.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstring>
#include <deque>

#include "mock_usb.hpp"
#include "plvo/usb/diagnosis.hpp"
#include "plvo/usb/kinect_motor.hpp"
#include "plvo/usb/usb_bus.hpp"

namespace plvo {
namespace {

constexpr double kDegree = 3.14159265358979323846 / 180;

const MockDeviceSpec kMotor{"1-1.1", 1, 4, 0x045e, 0x02b0, 0x0107, "12"};
const MockDeviceSpec kAudio{"1-1.2", 1, 5, 0x045e, 0x02ad};
const MockDeviceSpec kCamera{"1-1.3", 1, 6, 0x045e, 0x02ae};

class MockedUsb : public ::testing::Test {
 protected:
  void TearDown() override { ::setfsuid(::geteuid()); }

  SystemFacts gather() {
    SystemFacts facts = gather_facts(bus_);
    // Replaces the facts about the machine's own OpenNI2 by a folder with or without the Kinect's driver.
    facts.openni = {};
    facts.openni.found = facts.openni.directory_exists = true;
    facts.openni.directory = "/usr/lib/OpenNI2/Drivers";
    if (driver_installed_) facts.openni.files = {{"libFreenectDriver.so.0", ""}};
    facts.udev_rule = rule_;
    return facts;
  }
  std::string sentences() {
    std::string text;
    for (const Finding& finding : diagnose(gather())) {
      if (finding.severity != Severity::kNote) text += finding.what + "|" + finding.remedy + "\n";
    }
    return text;
  }
  void plug_kinect() {
    mock_.plug(kMotor);
    mock_.plug(kAudio);
    mock_.plug(kCamera);
  }

  MockUsb mock_;
  UsbBus bus_;
  bool driver_installed_ = true;
  std::string rule_ = "/etc/udev/rules.d/60-plvo-rgbd.rules";
};

TEST_F(MockedUsb, ReportsThatNothingIsPluggedIn) {
  EXPECT_EQ(sentences().find("No known RGB-D sensor is plugged in."), 0u) << sentences();
}

TEST_F(MockedUsb, UnknownDevicesAreIgnored) {
  mock_.plug({"1-2", 1, 9, 0x046d, 0xc077});
  EXPECT_TRUE(gather().devices.empty());
}

TEST_F(MockedUsb, ReportsAHealthyKinectAsReady) {
  plug_kinect();
  EXPECT_EQ(sentences(), "The Kinect v1 camera (port 1-1.3) is ready.|\n");
  const SystemFacts facts = gather();
  ASSERT_EQ(facts.devices.size(), 3u);
  EXPECT_EQ(facts.devices[2].node, "/dev/bus/usb/001/006");
  EXPECT_EQ(facts.devices[2].speed_mbps, 480);
  EXPECT_EQ(facts.devices[0].speed_mbps, 12);
  EXPECT_EQ(facts.devices[2].bcd, kKinect1414Bcd);
}

TEST_F(MockedUsb, NamesTheUdevRuleWhenPermissionIsDenied) {
  plug_kinect();
  rule_.clear();
  ASSERT_TRUE(bus_.open().ok());
  mock_.deny("1-1.3");
  const std::string text = sentences();
  EXPECT_NE(text.find("No permission to use the Kinect v1 camera (port 1-1.3), /dev/bus/usb/001/006."),
            std::string::npos)
      << text;
  EXPECT_NE(text.find("60-plvo-rgbd.rules"), std::string::npos) << text;
  EXPECT_EQ(text.find("ready"), std::string::npos) << text;
}

TEST_F(MockedUsb, ReportsTheMissingDriver) {
  plug_kinect();
  driver_installed_ = false;
  EXPECT_EQ(sentences().find(
                "OpenNI2 has no driver for the Kinect v1 in /usr/lib/OpenNI2/Drivers.|plvo brings its own"),
            0u)
      << sentences();
}

TEST_F(MockedUsb, ReportsTheMissingTwelveVolts) {
  mock_.plug(kMotor);
  EXPECT_NE(sentences().find("no 12 V supply"), std::string::npos) << sentences();
}

TEST_F(MockedUsb, KinectInUseByAnotherProgram) {
  mock_.plug(kMotor);
  MockBehaviour held;
  held.claim_errno = EBUSY;
  mock_.plug(kCamera, held);
  EXPECT_NE(sentences().find("is busy"), std::string::npos) << sentences();
}

TEST_F(MockedUsb, NamesTheWebcamDriverThatHoldsTheKinect) {
  mock_.plug(kMotor);
  MockDeviceSpec camera = kCamera;
  camera.kernel_driver = "gspca_kinect";
  mock_.plug(camera);
  EXPECT_NE(sentences().find("modprobe -r gspca_kinect"), std::string::npos) << sentences();
}

TEST_F(MockedUsb, ReportsAFullSpeedPort) {
  mock_.plug(kMotor);
  MockDeviceSpec camera = kCamera;
  camera.speed = "12";
  mock_.plug(camera);
  EXPECT_NE(sentences().find("runs at 12 Mbit/s"), std::string::npos) << sentences();
}

TEST_F(MockedUsb, UsbfsMemoryIsRead) {
  plug_kinect();
  mock_.set_usbfs_memory(8);
  EXPECT_EQ(gather().usbfs_memory_mb, 8);
}

TEST_F(MockedUsb, HotPlugReportsArrivalAndDeparture) {
  ASSERT_TRUE(bus_.open().ok());
  EXPECT_FALSE(bus_.camera_present());
  const Status watching = bus_.watch();
  ASSERT_TRUE(watching.ok()) << watching.message();
  const auto wait = [this] {
    std::vector<UsbEvent> events;
    for (int i = 0; i < 40 && events.empty(); ++i) events = bus_.poll(50);
    return events;
  };
  mock_.plug(kCamera);
  std::vector<UsbEvent> events = wait();
  ASSERT_EQ(events.size(), 1u);
  EXPECT_EQ(events[0].kind, UsbEvent::Kind::kArrived);
  EXPECT_STREQ(events[0].known.name, "Kinect v1 camera");
  EXPECT_EQ(events[0].port, "1-1.3");
  EXPECT_TRUE(bus_.camera_present());

  mock_.unplug("1-1.3");
  events = wait();
  ASSERT_EQ(events.size(), 1u);
  EXPECT_EQ(events[0].kind, UsbEvent::Kind::kLeft);
  EXPECT_FALSE(bus_.camera_present());
}

// The motor device of model 1414 as documented by the OpenKinect project.
struct FakeMotor {
  std::array<std::uint8_t, 10> state{};
  int tilt_half_degrees = 999;
  int light = -1;
  int fail = 0;

  MockBehaviour behaviour() {
    MockBehaviour b;
    b.control = [this](const std::uint8_t* setup, std::uint8_t* data, int length) {
      if (fail != 0) return fail;
      const int value = static_cast<std::int16_t>(setup[2] | (setup[3] << 8));
      if (setup[0] == 0xC0 && setup[1] == 0x32 && length == 10) {
        std::memcpy(data, state.data(), state.size());
        return 10;
      }
      if (setup[0] == 0x40 && setup[1] == 0x31) return tilt_half_degrees = value, 0;
      if (setup[0] == 0x40 && setup[1] == 0x06) return light = value, 0;
      return -EPIPE;
    };
    return b;
  }
};

TEST_F(MockedUsb, MovesTheMotorOf1414) {
  FakeMotor fake;
  // Gravity along +y with small components along +x and −z; tilt 10 degrees; at the limit.
  fake.state = {0, 0, 0x00, 0x52, 0x03, 0x33, 0xff, 0xae, 20, 1};
  mock_.plug(kMotor, fake.behaviour());
  mock_.plug(kCamera);
  ASSERT_TRUE(bus_.open().ok());
  KinectMotor motor;
  const Status opened = motor.open(bus_);
  ASSERT_TRUE(opened.ok()) << opened.message();
  EXPECT_FALSE(motor.through_audio());

  KinectState state;
  ASSERT_TRUE(motor.read(state).ok());
  EXPECT_NEAR(state.acceleration.x(), 82.0 / 819 * 9.80665, 1e-12);
  EXPECT_NEAR(state.acceleration.y(), 9.80665, 1e-12);
  EXPECT_NEAR(state.acceleration.z(), -82.0 / 819 * 9.80665, 1e-12);
  EXPECT_NEAR(state.tilt_rad, 10 * kDegree, 1e-12);
  EXPECT_TRUE(state.at_limit);
  EXPECT_FALSE(state.moving);
  fake.state[8] = static_cast<std::uint8_t>(-17);
  fake.state[9] = 4;
  ASSERT_TRUE(motor.read(state).ok());
  EXPECT_NEAR(state.tilt_rad, -8.5 * kDegree, 1e-12);
  EXPECT_TRUE(state.moving);

  ASSERT_TRUE(motor.set_tilt(-12.5 * kDegree).ok());
  EXPECT_EQ(fake.tilt_half_degrees, -25);
  ASSERT_TRUE(motor.set_tilt(90 * kDegree).ok());
  EXPECT_EQ(fake.tilt_half_degrees, 62);
  EXPECT_EQ(motor.set_tilt(std::nan("")).code(), StatusCode::kInvalidArgument);
  ASSERT_TRUE(motor.set_light(KinectLight::kBlinkRedYellow).ok());
  EXPECT_EQ(fake.light, 6);
  fake.fail = -EPIPE;
  EXPECT_EQ(motor.read(state).code(), StatusCode::kIo);
  fake.fail = -ENODEV;
  EXPECT_EQ(motor.read(state).code(), StatusCode::kUnplugged);
}

TEST_F(MockedUsb, MotorWithoutPermissionNamesTheRule) {
  mock_.plug(kMotor);
  ASSERT_TRUE(bus_.open().ok());
  mock_.deny("1-1.1");
  KinectMotor motor;
  const Status status = motor.open(bus_);
  EXPECT_EQ(status.code(), StatusCode::kPermission);
  EXPECT_NE(std::string(status.message()).find("60-plvo-rgbd.rules"), std::string::npos) << status.message();
}

// Each Kinect has its own hub: the motor must be on the hub of the camera in use.
TEST_F(MockedUsb, MotorOnTheHubOfTheCameraIsChosen) {
  FakeMotor first, second;
  first.state[8] = 20;
  second.state[8] = 40;
  mock_.plug(kMotor, first.behaviour());
  mock_.plug(kCamera);
  mock_.plug({"1-2", 1, 10, 0x0409, 0x005a});
  mock_.plug({"1-2.1", 1, 11, 0x045e, 0x02b0, 0x0107, "12"}, second.behaviour());
  mock_.plug({"1-2.3", 1, 12, 0x045e, 0x02ae});
  ASSERT_TRUE(bus_.open().ok());
  KinectMotor motor;
  KinectState state;
  for (const auto& [port, degrees] : {std::pair("1-1.3", 10), std::pair("1-2.3", 20), std::pair("", 10)}) {
    const Status opened = motor.open(bus_, port);
    ASSERT_TRUE(opened.ok()) << opened.message();
    ASSERT_TRUE(motor.read(state).ok());
    EXPECT_NEAR(state.tilt_rad, degrees * kDegree, 1e-12) << port;
  }
  EXPECT_EQ(motor.open(bus_, "1-4.3").code(), StatusCode::kNotFound);
}

TEST_F(MockedUsb, ReportsThatThereIsNoMotor) {
  ASSERT_TRUE(bus_.open().ok());
  KinectMotor motor;
  EXPECT_EQ(motor.open(bus_).code(), StatusCode::kNotFound);
  KinectState state;
  EXPECT_EQ(motor.read(state).code(), StatusCode::kInvalidArgument);
}

// The audio device of model 1473 and Kinect for Windows: commands have five words, replies three.
struct FakeAudio {
  std::deque<std::vector<std::uint8_t>> answers;
  std::uint32_t command = 0, argument = 0, length = 0, refuse = 0;

  static void put(std::vector<std::uint8_t>& to, std::uint32_t value) {
    for (int i = 0; i < 4; ++i) to.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
  }
  static std::uint32_t get(const std::uint8_t* from) {
    std::uint32_t value = 0;
    for (int i = 4; i-- > 0;) value = value << 8 | from[i];
    return value;
  }
  MockBehaviour behaviour() {
    MockBehaviour b;
    b.bulk = [this](unsigned endpoint, std::uint8_t* data, int size) {
      if (endpoint == 0x01) {
        if (size != 20 || get(data) != 0x06022009) return -EPIPE;
        length = get(data + 8);
        command = get(data + 12);
        argument = get(data + 16);
        if (length > 0) {
          std::vector<std::uint8_t> state(16);
          put(state, 819);
          put(state, static_cast<std::uint32_t>(-819));
          put(state, 0);
          put(state, static_cast<std::uint32_t>(-7));
          state.resize(length);
          answers.push_back(state);
        }
        std::vector<std::uint8_t> reply;
        put(reply, 0x0a6fe000);
        put(reply, get(data + 4));
        put(reply, refuse);
        answers.push_back(reply);
        return 20;
      }
      if (endpoint != 0x81 || answers.empty() || static_cast<int>(answers.front().size()) > size)
        return -EPIPE;
      const int moved = static_cast<int>(answers.front().size());
      std::memcpy(data, answers.front().data(), answers.front().size());
      answers.pop_front();
      return moved;
    };
    return b;
  }
};

TEST_F(MockedUsb, MovesTheMotorOf1473ThroughTheAudioDevice) {
  FakeAudio fake;
  MockDeviceSpec camera = kCamera;
  camera.bcd = 0x0114;
  mock_.plug(kMotor);
  mock_.plug(kAudio, fake.behaviour());
  mock_.plug(camera);
  ASSERT_TRUE(bus_.open().ok());
  KinectMotor motor;
  const Status opened = motor.open(bus_);
  ASSERT_TRUE(opened.ok()) << opened.message();
  EXPECT_TRUE(motor.through_audio());

  KinectState state;
  const Status read = motor.read(state);
  ASSERT_TRUE(read.ok()) << read.message();
  EXPECT_EQ(fake.command, 0x8032u);
  EXPECT_EQ(fake.length, 0x68u);
  EXPECT_NEAR((state.acceleration - Vector3(9.80665, -9.80665, 0)).norm(), 0, 1e-12);
  EXPECT_NEAR(state.tilt_rad, -7 * kDegree, 1e-12);
  ASSERT_TRUE(motor.set_tilt(-20 * kDegree).ok());
  EXPECT_EQ(fake.command, 0x803bu);
  EXPECT_EQ(static_cast<std::int32_t>(fake.argument), -20);
  ASSERT_TRUE(motor.set_light(KinectLight::kGreen).ok());
  EXPECT_EQ(fake.command, 0x10u);
  EXPECT_EQ(fake.argument, 3u);
  fake.refuse = 5;
  EXPECT_EQ(motor.set_light(KinectLight::kOff).code(), StatusCode::kDamaged);
}

}  // namespace
}  // namespace plvo
