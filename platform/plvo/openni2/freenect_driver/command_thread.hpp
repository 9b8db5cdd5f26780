// SPDX-License-Identifier: Apache-2.0
// A thread with exclusive access to an object that is not thread-safe. Other threads pass commands to it and
// wait for their results. Between commands it runs the periodic work of the object. When it ends, every
// accepted command has been executed, later commands are refused, and no thread waits any longer.
#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace plvo {

class CommandThread {
 public:
  // idle: called repeatedly; if it returns false, there was no work and the thread pauses briefly. at_end:
  // called before the thread ends. Both run on the thread, and all that they use must outlive it.
  CommandThread(std::function<bool()> idle, std::function<void()> at_end);
  ~CommandThread() { stop(); }
  CommandThread(const CommandThread&) = delete;
  CommandThread& operator=(const CommandThread&) = delete;

  // Executes `command` on the thread and returns its result. After stop() it returns false without executing
  // it. A call from within a command or from idle executes it directly.
  bool call(const std::function<bool()>& command);

  // Returns when the thread has ended and all waiting calls of call() have returned. Must not be called on
  // the thread itself, and only by one thread.
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
