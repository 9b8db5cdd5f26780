// SPDX-License-Identifier: Apache-2.0
#include "plvo/openni2/freenect_driver/command_thread.hpp"

#include <chrono>
#include <utility>

namespace plvo {
namespace {

constexpr std::chrono::milliseconds kRest(5);

// The CommandThread that runs on this thread, if any.
thread_local const CommandThread* current = nullptr;

}  // namespace

CommandThread::CommandThread(std::function<bool()> idle, std::function<void()> at_end)
    : idle_(std::move(idle)), at_end_(std::move(at_end)) {
  thread_ = std::thread([this] { run(); });
}

bool CommandThread::call(const std::function<bool()>& command) {
  if (current == this) return command();
  std::unique_lock lock(mutex_);
  if (stopped_) return false;
  Command mine{&command};
  waiting_.push_back(&mine);
  ++callers_;
  wake_.notify_one();
  changed_.wait(lock, [&] { return mine.done; });
  --callers_;
  changed_.notify_all();  // under the lock, so that stop() cannot return before this call ends
  return mine.result;
}

void CommandThread::run() {
  current = this;
  std::unique_lock lock(mutex_);
  for (;;) {
    const std::vector<Command*> commands = std::exchange(waiting_, {});
    if (commands.empty() && stopped_) break;
    lock.unlock();
    for (Command* command : commands) command->result = (*command->work)();
    const bool busy = commands.empty() && idle_();
    lock.lock();
    for (Command* command : commands) command->done = true;
    if (!commands.empty()) {
      changed_.notify_all();
    } else if (!busy) {
      wake_.wait_for(lock, kRest, [this] { return stopped_ || !waiting_.empty(); });
    }
  }
  lock.unlock();
  at_end_();
}

void CommandThread::stop() {
  {
    const std::lock_guard lock(mutex_);
    stopped_ = true;
    wake_.notify_one();
  }
  if (thread_.joinable()) thread_.join();
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return callers_ == 0; });
}

}  // namespace plvo
