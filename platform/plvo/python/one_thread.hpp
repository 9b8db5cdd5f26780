// SPDX-License-Identifier: Apache-2.0
// Objects that let other Python threads run while they work: two threads that meet in one of them are told
// so.
#pragma once

#include <atomic>
#include <stdexcept>
#include <string>

namespace plvo::python {

class OneThread {
 public:
  // owner: what the error calls it, "Odometry".
  explicit OneThread(const char* owner) : owner_(owner) {}

  // Keeps other threads out until its end.
  class Use {
   public:
    explicit Use(OneThread& of) : of_(of) {
      if (of.busy_.test_and_set())
        throw std::runtime_error("this " + std::string(of.owner_) +
                                 " is at work in another thread; give each thread its own");
    }
    ~Use() { of_.busy_.clear(); }
    Use(const Use&) = delete;
    Use& operator=(const Use&) = delete;

   private:
    OneThread& of_;
  };

 private:
  const char* owner_;
  std::atomic_flag busy_;
};

}  // namespace plvo::python
