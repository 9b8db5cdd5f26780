// SPDX-License-Identifier: Apache-2.0
// The thread that says when waiting requests are answered, and composes the updates among the replies: images
// are encoded and numbers put into words here, so that neither the odometry nor the thread that moves the
// bytes ever waits for it. Who has had more bytes than the limit allows waits longer, in the order of asking,
// and gets what is the newest then.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "plvo/view/rate_limit.hpp"
#include "plvo/view/view_hub.hpp"

namespace plvo {

class ReplyQueue {
 public:
  static constexpr int kPatience_ms = 1000;  // without news for so long, a viewer gets an empty reply
  // What a reply costs of the limit beside the bytes in it.
  static constexpr std::int64_t kReplyBytes = 16 * 1024;

  struct Request {
    std::string address;
    std::optional<ViewHub::Ask> ask;  // of a request for an update
    std::int64_t bytes = 0;           // of the reply to any other
    std::function<bool()> is_over;    // nobody is there any more to get the reply
    // Gets the update, or an empty text, on this queue's thread; see ViewHub::reply.
    std::function<void(std::string)> done;
  };

  // limit: in bytes. tick: called several times a second.
  ReplyQueue(ViewHub& hub, RateLimit& limit, std::function<void()> tick);
  ~ReplyQueue() { stop(); }
  ReplyQueue(const ReplyQueue&) = delete;
  ReplyQueue& operator=(const ReplyQueue&) = delete;

  void start();
  // Answers whoever still waits with nothing, and ends the thread.
  void stop();
  // False, and done is not called, once the queue is stopped.
  bool add(Request request);
  // There is news. From any thread; never waits.
  void wake();

 private:
  struct Waiting {
    Request request;
    std::int64_t until_ns = 0;
  };
  void run();
  bool wait();
  std::optional<Request> take_ready();
  std::string compose(const Request& request);

  ViewHub& hub_;
  RateLimit& limit_;
  const std::function<void()> tick_;
  std::thread thread_;
  std::atomic<bool> woken_{false};
  std::mutex mutex_;  // the following; never held while composing
  std::condition_variable work_;
  std::vector<Waiting> waiting_;  // who has waited for longest first
  bool stopped_ = true;
};

}  // namespace plvo
