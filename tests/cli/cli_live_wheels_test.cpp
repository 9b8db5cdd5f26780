// SPDX-License-Identifier: Apache-2.0
// `plvo live --wheels` with the simulated camera on a robot: its lines come through pipes, at their own pace,
// damaged, too few, or not at all.
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>
#include <vector>

#include "plvo_command.hpp"

namespace plvo {
namespace {

using test::CommandResult;

const std::string kBase = " --base-camera 0.2 0 0.5 -0.5 0.5 -0.5 0.5 ";
const std::string kRobot = "--robot --scene hall --size 320x240 --frames 45 --covered 15:30 ";
const std::string kLive = " live --quiet --pace fast --camera sim " + kRobot + kBase;

class CliLiveWheels : public test::PlvoCommand {
 protected:
  static std::string recording() {
    static const test::TemporaryFolder folder;
    static const bool made = [] {
      const auto result = plvo("simulate --quiet --out " + (folder / "sequence").string() + ' ' + kRobot);
      EXPECT_EQ(result.exit_code, 0) << result.err;
      return true;
    }();
    EXPECT_TRUE(made);
    return (folder / "sequence").string();
  }
  static std::string wheels() { return recording() + "/wheel_odometry.txt"; }
  static std::vector<std::string> lines() {
    std::vector<std::string> found;
    std::istringstream text(test::read_file(wheels()));
    for (std::string line; std::getline(text, line);) found.push_back(line + '\n');
    return found;
  }
  static std::string text_of(std::size_t count) {
    std::string text;
    for (const std::string& line : lines())
      if (count-- > 0)
        text += line;
      else
        break;
    return text;
  }
  // A named pipe that stays open, with these bytes in it.
  int pipe_with(const std::string& text) {
    EXPECT_EQ(::mkfifo(path("pipe").c_str(), 0600), 0);
    const int descriptor = ::open(path("pipe").c_str(), O_RDWR | O_CLOEXEC);
    EXPECT_EQ(::write(descriptor, text.data(), text.size()), static_cast<ssize_t>(text.size()));
    return descriptor;
  }
  // A program whose standard output is the standard input of plvo.
  CommandResult piped(const std::string& text, const std::string& more = "") const {
    test::write_file(folder_ / "lines.txt", text);
    return test::run_command("( cat " + path("lines.txt") + " | " + test::kPlvo + kLive + more +
                             " --wheels - --json " + path("s.json") + " )");
  }
  nlohmann::json summary() const { return nlohmann::json::parse(test::read_file(folder_ / "s.json")); }
};

TEST_F(CliLiveWheels, PosesAreThoseOfARunWithTheFile) {
  ASSERT_EQ(plvo("run --quiet " + recording() + " --wheels " + wheels() + kBase + "--out " + path("run.txt"))
                .exit_code,
            0);
  const std::string live = kLive + "--wheels " + wheels() + " --json " + path("s.json");
  const CommandResult result = plvo(live + " --out " + path("live.txt") + " --record " + path("kept"));
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.err, "");
  EXPECT_EQ(test::read_file(folder_ / "live.txt"), test::read_file(folder_ / "run.txt"));
  EXPECT_EQ(summary()["lost"], 0);
  EXPECT_GE(summary()["predicted"], 15) << "the lens is covered";
  EXPECT_EQ(summary()["wheels"]["frames_with"], 44);
  EXPECT_EQ(summary()["wheels"]["frames_without"], 0);
  EXPECT_EQ(summary()["wheels"]["left_out"], 0);
  // What it kept is a recording with wheels.
  ASSERT_EQ(plvo("run --quiet " + path("kept") + " --wheels " + path("kept/wheel_odometry.txt") + kBase +
                 "--out " + path("again.txt"))
                .exit_code,
            0);
  EXPECT_EQ(test::read_file(folder_ / "again.txt"), test::read_file(folder_ / "run.txt"));
}

// The camera at its own pace, and each line written when it is due, to a real pipe.
TEST_F(CliLiveWheels, LinesThatComeAtTheirOwnPaceAreUsed) {
  const int descriptor = pipe_with("");
  std::atomic<bool> end{false};
  std::thread writer([&] {
    const std::vector<std::string> all = lines();
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    const auto start = std::chrono::steady_clock::now();
    double first_s = 0;
    for (const std::string& line : all) {
      if (line[0] == '#') continue;
      const double stamp_s = std::stod(line);
      if (first_s == 0) first_s = stamp_s;
      std::this_thread::sleep_until(start + std::chrono::duration_cast<std::chrono::nanoseconds>(
                                                std::chrono::duration<double>(stamp_s - first_s)));
      if (end || ::write(descriptor, line.data(), line.size()) < 0) return;
    }
  });
  const CommandResult result = plvo("live --quiet --camera sim " + kRobot + kBase + "--wheels " +
                                    path("pipe") + " --json " + path("s.json"));
  end = true;
  writer.join();
  ::close(descriptor);
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_GE(summary()["wheels"]["frames_with"], 30) << result.err;
  EXPECT_EQ(summary()["wheels"]["left_out"], 0) << result.err;
}

TEST_F(CliLiveWheels, ALineThatIsDamagedIsLeftOutAndTold) {
  std::string text;
  std::size_t number = 0;
  for (const std::string& line : lines()) {
    ++number;
    text += number == 40 ? "1600000000.7 0.5 zero 0\n" : line;
    if (number == 50) text += "1 0 0 0\n";
  }
  const CommandResult result = piped(text);
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.err.find("standard input line 40: 'zero' is not a number; the line is left out"),
            std::string::npos)
      << result.err;
  EXPECT_NE(result.err.find("standard input line 51: is not later than the line before"), std::string::npos)
      << result.err;
  EXPECT_EQ(summary()["wheels"]["left_out"], 2);
  EXPECT_EQ(summary()["lost"], 0);
}

TEST_F(CliLiveWheels, NonsenseIsCountedAndHoldsNothingUp) {
  const CommandResult result = test::run_command("( yes 1 0 0 0 | " + test::kPlvo + kLive +
                                                 "--wheels - --json " + path("s.json") + " )");
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.err.find("further lines of the wheels that are left out are only counted"),
            std::string::npos);
  EXPECT_EQ(summary()["frames"], 45);
  EXPECT_EQ(summary()["wheels"]["frames_with"], 0);
}

TEST_F(CliLiveWheels, AStreamThatEndsIsTold) {
  const CommandResult result = piped(text_of(60));
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.err.find("standard input has ended; frames are tracked without wheels"), std::string::npos)
      << result.err;
  EXPECT_EQ(summary()["frames"], 45);
  EXPECT_GT(summary()["wheels"]["frames_with"], 10);
  EXPECT_GT(summary()["wheels"]["frames_without"], 5);
}

TEST_F(CliLiveWheels, AStreamThatStallsIsTold) {
  const int descriptor = pipe_with(text_of(60));
  const CommandResult result =
      test::run_plvo(kLive + "--wheels " + path("pipe") + " --json " + path("s.json"));
  ::close(descriptor);
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.err.find("s older than the frame; frames are tracked without wheels until lines come"),
            std::string::npos)
      << result.err;
  EXPECT_EQ(summary()["frames"], 45);
  EXPECT_GT(summary()["wheels"]["frames_with"], 10);
  EXPECT_GT(summary()["wheels"]["frames_without"], 5);
}

TEST_F(CliLiveWheels, AStreamThatDoesNotBeginIsTold) {
  const int descriptor = pipe_with("# a comment\n");
  const CommandResult result =
      test::run_plvo(kLive + "--wheels " + path("pipe") + " --json " + path("s.json"));
  ::close(descriptor);
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.err.find("no line of the wheels has come from " + path("pipe") + " yet"),
            std::string::npos)
      << result.err;
  EXPECT_EQ(summary()["wheels"]["frames_with"], 0);
  EXPECT_EQ(summary()["wheels"]["frames_without"], 44);
}

TEST_F(CliLiveWheels, WhatDoesNotApplyIsRefused) {
  const std::string live = "live --camera sim " + kRobot;
  expect_refused(plvo(live + "--wheels " + wheels()), 2, "--wheels: needs --base-camera");
  expect_refused(plvo(live + "--wheels-error 0.1"), 2, "is for --wheels");
  expect_refused(plvo(live + "--wheels " + path("none") + kBase), 1, "none: No such file");
  expect_refused(plvo(live + "--wheels " + recording() + kBase), 1, "it is a folder");
  expect_refused(plvo(live + "--wheels " + wheels() + kBase + "--out " + wheels()), 2, "is an input");
  expect_refused(plvo(live + "--wheels " + wheels() + kBase + "--record " + recording()), 2, "is an input");
  std::filesystem::create_directory(folder_ / "new");
  test::write_file(folder_ / "new/wheel_odometry.txt", "1 0 0 0\n");
  expect_refused(plvo(live + "--wheels " + wheels() + kBase + "--record " + path("new")), 1,
                 "has wheel_odometry.txt already");
}

}  // namespace
}  // namespace plvo
