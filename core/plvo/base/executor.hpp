// SPDX-License-Identifier: Apache-2.0
// Two pieces of work that may run at the same time, where the platform has a second core to offer
// (plvo/hal/task_pair.hpp). Neither reads what the other writes, so that the result is the same bits whether
// they do.
#pragma once

namespace plvo {

// A function and what it works on, both the caller's for the call.
struct Task {
  void (*call)(void* context) = nullptr;
  void* context = nullptr;
  void operator()() const { call(context); }
};

struct Executor {
  // Returns when both are done. nullptr: one after the other, on the caller's thread.
  void (*run)(void* runner, Task here, Task beside) = nullptr;
  void* runner = nullptr;

  explicit operator bool() const { return run != nullptr; }

  template <typename Here, typename Beside>
  void both(Here&& here, Beside&& beside) const {
    if (run == nullptr) {
      here();
      beside();
    } else {
      start(task_of(here), task_of(beside));
    }
  }

  // work(begin, end) over 0 … count, in halves.
  template <typename Count, typename Work>
  void halves(Count count, Work&& work) const {
    if (run == nullptr) return work(Count{0}, count);
    const Count middle = count / 2;
    both([&] { work(Count{0}, middle); }, [&] { work(middle, count); });
  }

 private:
  void start(Task here, Task beside) const;

  template <typename Callable>
  static Task task_of(Callable& callable) {
    return {[](void* context) { (*static_cast<Callable*>(context))(); }, &callable};
  }
};

}  // namespace plvo
