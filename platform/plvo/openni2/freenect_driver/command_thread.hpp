// SPDX-License-Identifier: Apache-2.0
// A thread that alone touches something which is not made for several: others hand it commands and wait for
// them. Between commands it does what the thing needs to live. When it ends, every command that was taken in
// has been carried out, every later one is refused, and nobody waits any more.
#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace plvo {

class CommandThread {
 public:
  // idle: called again and again; false when there was nothing to do, and the thread rests a little. at_end:
  // the last thing that the thread does. Both run on the thread, and what they use must outlive it.
  CommandThread(std::function<bool()> idle, std::function<void()> at_end);
  ~CommandThread() { stop(); }
  CommandThread(const CommandThread&) = delete;
  CommandThread& operator=(const CommandThread&) = delete;

  // Carries `command` out on the thread and returns its result; false, without having carried it out, once
  // stop() was called. From within a command, or from idle, it is carried out at once.
  bool call(const std::function<bool()>& command);

  // Returns when the thread has ended and whoever waited in call() has left it. Not to be called on the
  // thread itself, and by one thread only.
  void stop();

 private:
  struct Command {
    const std::function<bool()>* work;
    bool result = false;
    bool done = false;
  };
  void run();

  std::function<bool()> idle_;
  std::function<void()> at_end_;
  std::mutex mutex_;
  std::condition_variable wake_, changed_;
  std::vector<Command*> waiting_;
  int callers_ = 0;
  bool stopped_ = false;
  std::thread thread_;
};

}  // namespace plvo
