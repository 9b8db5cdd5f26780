// SPDX-License-Identifier: Apache-2.0
// Runs the built program with the virtual device, as a user does: starts it in the background, controls it
// through the device's pipe and with signals, and reads its output after it has ended.
#pragma once

#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <string>
#include <thread>

#include "command.hpp"
#include "plvo_binary.hpp"
#include "temporary_folder.hpp"

namespace plvo_test {

using plvo::test::kPlvo;
using plvo::test::read_file;
using plvo::test::run_command;

// Time limit, so that a hang fails with a message; no timing is judged by it.
inline constexpr double kPatience_s = 120;

inline bool contains(const std::string& text, const std::string& words) {
  return text.find(words) != std::string::npos;
}
inline long lines_in(const std::string& text) { return std::count(text.begin(), text.end(), '\n'); }

class LiveCommand : public testing::Test {
 protected:
  LiveCommand() { EXPECT_EQ(::mkfifo(path("control").c_str(), 0600), 0); }
  ~LiveCommand() override {
    if (pid_ > 0) {
      ::kill(pid_, SIGKILL);
      ::waitpid(pid_, nullptr, 0);
    }
  }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  // Commands for the virtual device at start; see virtual_device.hpp.
  static std::string device(const std::string& commands, const std::string& frames = "") {
    return "PLVO_VIRTUAL_START='" + commands + "' " +
           (frames.empty() ? "" : "PLVO_VIRTUAL_FRAMES=" + frames + " ");
  }
  static plvo::test::CommandResult plvo(const std::string& arguments, const std::string& environment = "") {
    return run_command(environment + kPlvo + ' ' + arguments);
  }

  // before: shell commands for this process only, such as a limit.
  void start(const std::string& arguments, const std::string& environment = "",
             const std::string& before = "") {
    // exec replaces the shell by the program, which then receives the signals.
    const std::string command = before + "exec env PLVO_VIRTUAL_CONTROL=" + path("control") + ' ' +
                                environment + kPlvo + ' ' + arguments + " >" + path("out") + " 2>" +
                                path("err") + " </dev/null";
    pid_ = ::fork();
    if (pid_ == 0) {
      ::execl("/bin/sh", "sh", "-c", command.c_str(), nullptr);
      ::_exit(127);
    }
  }
  std::string err() const { return read_file(folder_ / "err"); }
  std::string out() const { return read_file(folder_ / "out"); }
  bool says(const std::string& words, double limit_s = kPatience_s) const {
    const auto start = std::chrono::steady_clock::now();
    while (!contains(err(), words)) {
      if (std::chrono::steady_clock::now() - start > std::chrono::duration<double>(limit_s)) return false;
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    return true;
  }
  // Fails, instead of waiting, if the program and with it the device has ended.
  void tell_device(const std::string& command) const {
    const int fd = ::open(path("control").c_str(), O_WRONLY | O_NONBLOCK | O_CLOEXEC);
    ASSERT_GE(fd, 0) << "the program has ended: " << err();
    const std::string line = command + '\n';
    EXPECT_EQ(::write(fd, line.data(), line.size()), static_cast<ssize_t>(line.size()));
    ::close(fd);
  }
  // Sends a signal as another program or a terminal does.
  void send(int signal) const {
    if (pid_ > 0) ::kill(pid_, signal);  // kill(-1) would signal every process
  }
  // Sends Ctrl-C and returns the exit code; -1 if the program does not end in time.
  int interrupt() {
    send(SIGINT);
    return wait();
  }
  // Waits until the condition is true; false if this does not happen in time.
  template <typename Condition>
  static bool comes_true(Condition condition) {
    for (double waited_s = 0; waited_s < kPatience_s; waited_s += 0.01) {
      if (condition()) return true;
      pause(0.01);
    }
    return false;
  }
  int wait(double limit_s = kPatience_s) {
    if (pid_ <= 0) return -1;
    const auto start = std::chrono::steady_clock::now();
    int status = 0;
    while (::waitpid(pid_, &status, WNOHANG) == 0) {
      if (std::chrono::steady_clock::now() - start > std::chrono::duration<double>(limit_s)) return -1;
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    pid_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  }
  static void pause(double seconds) { std::this_thread::sleep_for(std::chrono::duration<double>(seconds)); }

  plvo::test::TemporaryFolder folder_;
  pid_t pid_ = -1;
};

}  // namespace plvo_test
