// SPDX-License-Identifier: Apache-2.0
// The thread that composes the replies to waiting viewers: images are encoded and numbers put into words
// here, so that neither the odometry nor the thread that moves the bytes ever waits for it.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "plvo/view/view_hub.hpp"

namespace plvo {

class ReplyQueue {
 public:
  static constexpr int kPatience_ms = 1000;  // without news for so long, a viewer gets an empty reply

  // done: gets the reply, on this queue's thread; see ViewHub::reply. tick: called several times a second.
  ReplyQueue(ViewHub& hub, std::function<void()> tick);
  ~ReplyQueue() { stop(); }
  ReplyQueue(const ReplyQueue&) = delete;
  ReplyQueue& operator=(const ReplyQueue&) = delete;

  void start();
  // Answers whoever still waits with nothing, and ends the thread.
  void stop();
  // False, and done is not called, once the queue is stopped.
  bool add(const ViewHub::Ask& ask, std::function<void(std::string)> done);
  // There is news. From any thread; holds a mutex for a few instructions.
  void wake();

 private:
  struct Waiting {
    ViewHub::Ask ask;
    std::int64_t until_ns = 0;
    std::function<void(std::string)> done;
  };
  void run();
  std::vector<Waiting> take_ready();

  ViewHub& hub_;
  const std::function<void()> tick_;
  std::thread thread_;
  std::mutex mutex_;  // the following; never held while composing
  std::condition_variable work_;
  std::vector<Waiting> waiting_;
  bool woken_ = false;
  bool stopped_ = true;
};

}  // namespace plvo
