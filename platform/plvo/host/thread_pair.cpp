// SPDX-License-Identifier: Apache-2.0
#include "plvo/host/thread_pair.hpp"

#include "plvo/host/posix_clock.hpp"

namespace plvo {

ThreadPair::ThreadPair() : thread_([this] { work(); }) {}

ThreadPair::~ThreadPair() {
  {
    const std::lock_guard lock(mutex_);
    ended_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void ThreadPair::run(Task here, Task beside) {
  {
    const std::lock_guard lock(mutex_);
    task_ = beside;
  }
  changed_.notify_all();
  here();
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return task_.call == nullptr; });
}

void ThreadPair::work() {
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [this] { return ended_ || task_.call != nullptr; });
    if (task_.call == nullptr) return;
    const Task task = task_;
    lock.unlock();
    task();
    cpu_ns_ = posix_thread_cpu_ns();
    lock.lock();
    task_ = {};
    changed_.notify_all();
  }
}

}  // namespace plvo
