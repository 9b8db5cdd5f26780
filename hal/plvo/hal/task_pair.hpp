// SPDX-License-Identifier: Apache-2.0
// A second core for the odometry. Without it, the tasks run in sequence; the results are bit-identical.
#pragma once

#include "plvo/base/executor.hpp"

namespace plvo {

class TaskPair {
 public:
  // Runs both tasks, `here` on the calling thread, and returns when both are done. It is called by one thread
  // at a time, several times per frame.
  virtual void run(Task here, Task beside) = 0;

  // The value for Config::executor. The pair must outlive the odometry that uses it.
  Executor executor() {
    return {[](void* pair, Task here, Task beside) { static_cast<TaskPair*>(pair)->run(here, beside); },
            this};
  }

 protected:
  // Never deleted through the interface: a virtual destructor would require operator delete on every board.
  ~TaskPair() = default;
};

}  // namespace plvo
