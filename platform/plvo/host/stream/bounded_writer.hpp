// SPDX-License-Identifier: Apache-2.0
// Lines to a reader that may be slow, stuck or gone, without ever waiting for it: a bounded buffer, whole
// lines only. A line that does not fit is dropped and counted. A file on a disk is written line by line
// instead (whole_write.hpp): it is no reader, and a full disk must not leave half a line.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

namespace plvo {

class BoundedWriter {
 public:
  // Takes the descriptor over if `owns`. Sockets are written with MSG_DONTWAIT; anything else only when
  // poll() says that it is writable, in pieces no larger than PIPE_BUF, which a writable pipe takes without
  // blocking: so a standard output that others share need not be switched to non-blocking.
  BoundedWriter(int descriptor, bool is_socket, bool owns, std::size_t capacity);
  ~BoundedWriter();
  BoundedWriter(BoundedWriter&& other) noexcept;
  BoundedWriter& operator=(BoundedWriter&& other) noexcept;

  // line: with its newline. Sends what the reader takes now. False once the reader is gone.
  bool write(std::string_view line);
  // Gives the reader up to timeout_ms to take what is left.
  void drain(int timeout_ms);

  bool gone() const { return gone_; }
  std::uint64_t dropped() const { return dropped_; }
  std::uint64_t sent_bytes() const { return sent_bytes_; }  // that the operating system took
  bool all_sent() const { return buffer_.empty(); }
  int descriptor() const { return descriptor_; }

 private:
  void send_some();

  int descriptor_;
  bool is_socket_;
  bool is_file_;
  bool owns_;
  std::size_t capacity_;
  std::vector<char> buffer_;
  bool gone_ = false;
  std::uint64_t dropped_ = 0;
  std::uint64_t sent_bytes_ = 0;
};

}  // namespace plvo
