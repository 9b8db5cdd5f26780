// SPDX-License-Identifier: Apache-2.0
// A second core for the odometry. Without one it does one thing after the other; its results are the same
// bits.
#pragma once

#include "plvo/base/executor.hpp"

namespace plvo {

class TaskPair {
 public:
  // Does both and returns when both are done, `here` on the calling thread. Called by one thread at a time,
  // several times a frame.
  virtual void run(Task here, Task beside) = 0;

  // For Config::executor; the pair must live as long as the odometry that it is given to.
  Executor executor() {
    return {[](void* pair, Task here, Task beside) { static_cast<TaskPair*>(pair)->run(here, beside); },
            this};
  }

 protected:
  // Never deleted through the interface: a virtual destructor would ask every board for operator delete.
  ~TaskPair() = default;
};

}  // namespace plvo
