// SPDX-License-Identifier: Apache-2.0
#include "plvo/view/reply_queue.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

#include "plvo/host/background.hpp"
#include "plvo/host/posix_clock.hpp"

namespace plvo {
namespace {

constexpr int kTick_ms = 100;

}  // namespace

ReplyQueue::ReplyQueue(ViewHub& hub, RateLimit& limit, std::function<void()> tick)
    : hub_(hub), limit_(limit), tick_(std::move(tick)) {}

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

bool ReplyQueue::add(Request request) {
  if (request.ask) hub_.count_viewer(*request.ask);
  {
    const std::lock_guard lock(mutex_);
    if (stopped_) return false;
    waiting_.push_back({std::move(request), posix_monotonic_ns() + kPatience_ms * 1'000'000LL});
    woken_ = true;
  }
  work_.notify_one();
  return true;
}

// Does not lock the mutex: the odometry might have to wait for it. If the queue's thread has just read woken_
// and is about to sleep, it misses this call, and the next frame or tick wakes it.
void ReplyQueue::wake() {
  woken_ = true;
  work_.notify_one();
}

// Waits for news or the next tick; returns false once the queue is stopped.
bool ReplyQueue::wait() {
  std::unique_lock lock(mutex_);
  work_.wait_for(lock, std::chrono::milliseconds(kTick_ms), [this] { return woken_ || stopped_; });
  woken_ = false;
  return !stopped_;
}

// Returns the first request whose reply is due and allowed, or whose connection is over.
std::optional<ReplyQueue::Request> ReplyQueue::take_ready() {
  const std::lock_guard lock(mutex_);
  const std::int64_t now = posix_monotonic_ns();
  const auto ready = std::find_if(waiting_.begin(), waiting_.end(), [&](const Waiting& one) {
    const Request& request = one.request;
    if (stopped_ || request.is_over()) return true;
    const bool due = !request.ask || now >= one.until_ns || hub_.has_news(*request.ask);
    return due && limit_.allows(request.address, now);
  });
  if (ready == waiting_.end()) return std::nullopt;
  Request request = std::move(ready->request);
  waiting_.erase(ready);
  return request;
}

std::string ReplyQueue::compose(const Request& request) {
  if (request.is_over()) return {};
  std::string reply = request.ask ? hub_.reply(*request.ask) : std::string();
  limit_.spend(request.address, static_cast<std::int64_t>(reply.size()) + request.bytes + kReplyBytes,
               posix_monotonic_ns());
  return reply;
}

void ReplyQueue::run() {
  run_in_background();
  for (bool more = true; more;) {
    more = wait();
    while (std::optional<Request> request = take_ready()) {
      request->done(more ? compose(*request) : std::string());
      tick_();
    }
    tick_();
  }
}

}  // namespace plvo
