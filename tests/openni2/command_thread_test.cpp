// SPDX-License-Identifier: Apache-2.0
// The thread that owns the Kinect runs commands in order and on that thread, and its end releases every
// caller. Built a second time with ThreadSanitizer if the compiler supports it.
#include "plvo/openni2/freenect_driver/command_thread.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <memory>

namespace plvo {
namespace {

const std::function<bool()> kNothing = [] { return false; };

TEST(CommandThread, RunsCommandsOnItsOwnThread) {
  std::thread::id own, first, second;
  int order = 0;
  std::unique_ptr<CommandThread> thread;
  thread = std::make_unique<CommandThread>(kNothing, [&] { own = std::this_thread::get_id(); });
  EXPECT_TRUE(thread->call([&] {
    first = std::this_thread::get_id();
    // A command that calls the thread runs at once.
    return thread->call([&] { return ++order == 1; }) && ++order == 2;
  }));
  EXPECT_FALSE(thread->call([&] {
    second = std::this_thread::get_id();
    return false;
  }));
  thread->stop();
  EXPECT_EQ(own, first);
  EXPECT_EQ(own, second);
  EXPECT_NE(own, std::this_thread::get_id());
}

TEST(CommandThread, IdlesBetweenCommands) {
  std::atomic<int> idled = 0;
  CommandThread thread([&] { return ++idled % 2 == 0; }, [] {});
  while (idled < 10) std::this_thread::yield();
  EXPECT_TRUE(thread.call([] { return true; }));
}

// The thread executes every accepted command and refuses later ones, and every caller returns. In an earlier
// version the thread could end between the two, and a caller that had just handed over a command got an
// exception or waited forever.
TEST(CommandThread, EndingReleasesAllWaitingCalls) {
  constexpr int kRounds = 200;
  constexpr int kCallers = 4;
  long accepted = 0;
  for (int round = 0; round < kRounds; ++round) {
    // Not atomic: only the command thread runs the commands and the end function.
    int carried_out = 0;
    bool ended = false;
    auto thread = std::make_unique<CommandThread>(kNothing, [&] { ended = true; });
    std::atomic<int> said_so = 0;
    std::atomic<int> calling = 0;
    std::vector<std::thread> callers;
    for (int i = 0; i < kCallers; ++i) {
      callers.emplace_back([&] {
        ++calling;
        while (thread->call([&] {
          ++carried_out;
          return !ended;
        }))
          ++said_so;
      });
    }
    while (calling < kCallers) std::this_thread::yield();
    thread->stop();
    for (std::thread& caller : callers) caller.join();
    EXPECT_FALSE(thread->call([] { return true; }));
    thread.reset();
    EXPECT_EQ(said_so, carried_out);
    EXPECT_TRUE(ended);
    accepted += said_so;
  }
  EXPECT_GT(accepted, 0);
}

}  // namespace
}  // namespace plvo
