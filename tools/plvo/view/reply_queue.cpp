// SPDX-License-Identifier: Apache-2.0
#include "plvo/view/reply_queue.hpp"

#include <chrono>
#include <utility>

#include "plvo/host/posix_clock.hpp"

namespace plvo {
namespace {

constexpr int kTick_ms = 100;

}  // namespace

ReplyQueue::ReplyQueue(ViewHub& hub, std::function<void()> tick) : hub_(hub), tick_(std::move(tick)) {}

void ReplyQueue::start() {
  stopped_ = false;
  hub_.on_news([this] { wake(); });
  thread_ = std::thread([this] { run(); });
}

void ReplyQueue::stop() {
  {
    const std::lock_guard lock(mutex_);
    stopped_ = true;
  }
  work_.notify_one();
  if (thread_.joinable()) thread_.join();
}

bool ReplyQueue::add(const ViewHub::Ask& ask, std::function<void(std::string)> done) {
  hub_.count_viewer(ask);
  {
    const std::lock_guard lock(mutex_);
    if (stopped_) return false;
    waiting_.push_back({ask, posix_monotonic_ns() + kPatience_ms * 1'000'000LL, std::move(done)});
    woken_ = true;
  }
  work_.notify_one();
  return true;
}

void ReplyQueue::wake() {
  {
    const std::lock_guard lock(mutex_);
    woken_ = true;
  }
  work_.notify_one();
}

// Under mutex_: those for whom there is news, or who have waited long enough.
std::vector<ReplyQueue::Waiting> ReplyQueue::take_ready() {
  std::vector<Waiting> ready;
  const std::int64_t now = posix_monotonic_ns();
  std::erase_if(waiting_, [&](Waiting& one) {
    if (!stopped_ && now < one.until_ns && !hub_.has_news(one.ask)) return false;
    ready.push_back(std::move(one));
    return true;
  });
  return ready;
}

void ReplyQueue::run() {
  bool more = true;
  while (more) {
    std::vector<Waiting> ready;
    {
      std::unique_lock lock(mutex_);
      work_.wait_for(lock, std::chrono::milliseconds(kTick_ms), [this] { return woken_ || stopped_; });
      woken_ = false;
      more = !stopped_;
      ready = take_ready();
    }
    for (Waiting& one : ready) one.done(more ? hub_.reply(one.ask) : std::string());
    tick_();
  }
}

}  // namespace plvo
