// SPDX-License-Identifier: Apache-2.0
// The thread that decides when waiting requests are answered. It also composes the updates, that is, it
// encodes the images and formats the numbers, so that neither the odometry nor the thread that transfers the
// bytes waits for this. A viewer that exceeds its byte limit waits longer, in the order of the requests, and
// then gets the newest update.
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
  static constexpr int kPatience_ms = 1000;  // after this time without news a viewer gets an empty reply
  // Cost of a reply in addition to its bytes.
  static constexpr std::int64_t kReplyBytes = 16 * 1024;

  struct Request {
    std::string address;
    std::optional<ViewHub::Ask> ask;  // for a request for an update
    std::int64_t bytes = 0;           // of the reply to any other request
    std::function<bool()> is_over;    // true if the connection is gone
    // Receives the update, or an empty text, on this queue's thread; see ViewHub::reply.
    std::function<void(std::string)> done;
  };

  // limit: in bytes. tick: called several times a second.
  ReplyQueue(ViewHub& hub, RateLimit& limit, std::function<void()> tick);
  ~ReplyQueue() { stop(); }
  ReplyQueue(const ReplyQueue&) = delete;
  ReplyQueue& operator=(const ReplyQueue&) = delete;

  void start();
  // Sends an empty reply to every waiting request and ends the thread.
  void stop();
  // Returns false, without calling done, once the queue is stopped.
  bool add(Request request);
  // Signals news. Callable from any thread; never waits.
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
  std::mutex mutex_;  // guards the following members; never held while composing
  std::condition_variable work_;
  std::vector<Waiting> waiting_;  // the longest wait first
  bool stopped_ = true;
};

}  // namespace plvo
