// SPDX-License-Identifier: Apache-2.0
// Runs the second of two tasks on its own thread, which sleeps while there is no task.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <thread>

#include "plvo/hal/task_pair.hpp"

namespace plvo {

class ThreadPair final : public TaskPair {
 public:
  ThreadPair();
  ~ThreadPair();
  ThreadPair(const ThreadPair&) = delete;
  ThreadPair& operator=(const ThreadPair&) = delete;

  void run(Task here, Task beside) override;

  // Processor time of the second thread so far; between two runs.
  std::int64_t cpu_ns() const { return cpu_ns_; }

 private:
  void work();

  std::mutex mutex_;
  std::condition_variable changed_;
  Task task_;                // guarded by mutex_; without a call there is nothing to do
  bool ended_ = false;       // guarded by mutex_
  std::int64_t cpu_ns_ = 0;  // written by the thread before it says that its task is done
  std::thread thread_;
};

}  // namespace plvo
