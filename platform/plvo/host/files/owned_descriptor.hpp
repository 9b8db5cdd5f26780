// SPDX-License-Identifier: Apache-2.0
// A file descriptor that is closed at the end of its scope; -1 is none.
#pragma once

#include <unistd.h>

namespace plvo {

class OwnedDescriptor {
 public:
  explicit OwnedDescriptor(int number) : number_(number) {}
  OwnedDescriptor(const OwnedDescriptor&) = delete;
  OwnedDescriptor& operator=(const OwnedDescriptor&) = delete;
  ~OwnedDescriptor() {
    if (number_ >= 0) ::close(number_);
  }
  int get() const { return number_; }

 private:
  int number_;
};

}  // namespace plvo
