// SPDX-License-Identifier: Apache-2.0
// `plvo tilt` with a simulated motor below the real libusb, in this process because umockdev requires it.
#include <gtest/gtest.h>
#include <sys/fsuid.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <nlohmann/json.hpp>

#include "mock_usb.hpp"
#include "plvo/cli/command_line.hpp"

namespace plvo {
namespace {

const MockDeviceSpec kMotor{"1-1.1", 1, 4, 0x045e, 0x02b0, 0x0107, "12"};

// The motor of model 1414: it reports motion for two readings and then stands at the commanded tilt.
struct FakeMotor {
  int half_degrees = 20, goal = 20, moving = 0, light = -1;

  MockBehaviour behaviour() {
    MockBehaviour b;
    b.control = [this](const std::uint8_t* setup, std::uint8_t* data, int length) {
      const int value = static_cast<std::int16_t>(setup[2] | (setup[3] << 8));
      if (setup[0] == 0xC0 && setup[1] == 0x32 && length == 10) {
        if (moving > 0 && --moving == 0) half_degrees = goal;
        const std::array<std::uint8_t, 10> state = {
            0,
            0,
            0,
            0,
            0x03,
            0x33,
            0,
            0,
            static_cast<std::uint8_t>(moving > 0 ? -128 : half_degrees),
            static_cast<std::uint8_t>(moving > 0 ? 4 : 0)};
        std::memcpy(data, state.data(), state.size());
        return 10;
      }
      if (setup[0] == 0x40 && setup[1] == 0x31) return goal = value, moving = 3, 0;
      if (setup[0] == 0x40 && setup[1] == 0x06) return light = value, 0;
      return -EPIPE;
    };
    return b;
  }
};

class CliTilt : public ::testing::Test {
 protected:
  void TearDown() override { ::setfsuid(::geteuid()); }
  int tilt(std::vector<const char*> words) {
    words.insert(words.begin(), {"plvo", "tilt"});
    testing::internal::CaptureStdout();
    testing::internal::CaptureStderr();
    const int code = cli::run_command_line(static_cast<int>(words.size()), words.data());
    std::fflush(nullptr);
    out_ = testing::internal::GetCapturedStdout();
    err_ = testing::internal::GetCapturedStderr();
    return code;
  }
  MockUsb mock_;
  FakeMotor motor_;
  std::string out_, err_;
};

TEST_F(CliTilt, ReportsTheTilt) {
  mock_.plug(kMotor, motor_.behaviour());
  ASSERT_EQ(tilt({}), 0) << err_;
  EXPECT_NE(out_.find("+10.0 degrees against the horizon"), std::string::npos) << out_;
  EXPECT_NE(out_.find("+0.00 +9.81 +0.00 m/s2"), std::string::npos) << out_;
  EXPECT_EQ(motor_.light, -1) << "asked only";
  ASSERT_EQ(tilt({"--json", "-"}), 0) << err_;
  EXPECT_EQ(nlohmann::json::parse(out_)["tilt_deg"], 10.0);
}

TEST_F(CliTilt, SetsTheTiltWaitsAndSetsTheLight) {
  mock_.plug(kMotor, motor_.behaviour());
  ASSERT_EQ(tilt({"-12.5", "--led", "blink-green"}), 0) << err_;
  EXPECT_EQ(motor_.goal, -25);
  EXPECT_EQ(motor_.light, 4);
  EXPECT_NE(out_.find("-12.5 degrees"), std::string::npos) << "it has arrived: " << out_;
  EXPECT_EQ(tilt({"50"}), 2);
  EXPECT_EQ(motor_.goal, -25) << "nothing moved";
  EXPECT_NE(err_.find("from -31 to 31"), std::string::npos) << err_;
}

TEST_F(CliTilt, ReportsErrors) {
  EXPECT_EQ(tilt({}), 4);
  EXPECT_NE(err_.find("plvo: error: no Kinect v1 motor"), std::string::npos) << err_;
  EXPECT_EQ(tilt({"up"}), 2);
  EXPECT_EQ(tilt({"--led", "pink"}), 2);
  mock_.plug(kMotor, motor_.behaviour());
  mock_.deny("1-1.1");
  EXPECT_EQ(tilt({"3"}), 4);
  EXPECT_NE(err_.find("60-plvo-rgbd.rules"), std::string::npos) << err_;
}

}  // namespace
}  // namespace plvo
