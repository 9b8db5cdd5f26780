// SPDX-License-Identifier: Apache-2.0
// Two tasks that may run in parallel when the platform offers a second core (plvo/hal/task_pair.hpp). Neither
// task reads what the other writes, so the results are bit-identical in parallel and in sequence.
#pragma once

namespace plvo {

// A function and its context. The caller keeps the context alive until the call returns.
struct Task {
  void (*call)(void* context) = nullptr;
  void* context = nullptr;
  void operator()() const { call(context); }
};

struct Executor {
  // Returns when both tasks are done. nullptr: the tasks run in sequence on the caller's thread.
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

  // Calls work(begin, end) for the two halves of 0 … count.
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
