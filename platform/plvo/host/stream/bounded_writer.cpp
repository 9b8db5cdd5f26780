// SPDX-License-Identifier: Apache-2.0
#include "plvo/host/stream/bounded_writer.hpp"

#include <poll.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <climits>
#include <utility>

#include "plvo/host/files/whole_write.hpp"

namespace plvo {
namespace {

bool is_regular_file(int descriptor) {
  struct stat facts {};
  return ::fstat(descriptor, &facts) == 0 && S_ISREG(facts.st_mode);
}

}  // namespace

BoundedWriter::BoundedWriter(int descriptor, bool is_socket, bool owns, std::size_t capacity)
    : descriptor_(descriptor),
      is_socket_(is_socket),
      is_file_(!is_socket && is_regular_file(descriptor)),
      owns_(owns),
      capacity_(capacity) {
  buffer_.reserve(capacity);
}

BoundedWriter::BoundedWriter(BoundedWriter&& other) noexcept
    : descriptor_(std::exchange(other.descriptor_, -1)),
      is_socket_(other.is_socket_),
      is_file_(other.is_file_),
      owns_(other.owns_),
      capacity_(other.capacity_),
      buffer_(std::move(other.buffer_)),
      gone_(other.gone_),
      dropped_(other.dropped_),
      sent_bytes_(other.sent_bytes_) {}

BoundedWriter& BoundedWriter::operator=(BoundedWriter&& other) noexcept {
  std::swap(descriptor_, other.descriptor_);
  std::swap(owns_, other.owns_);
  is_socket_ = other.is_socket_;
  is_file_ = other.is_file_;
  capacity_ = other.capacity_;
  buffer_.swap(other.buffer_);
  gone_ = other.gone_;
  dropped_ = other.dropped_;
  sent_bytes_ = other.sent_bytes_;
  return *this;
}

BoundedWriter::~BoundedWriter() {
  if (owns_ && descriptor_ >= 0) ::close(descriptor_);
}

void BoundedWriter::send_some() {
  std::size_t done = 0;
  while (done < buffer_.size() && !gone_) {
    ssize_t sent = 0;
    if (is_socket_) {
      sent = ::send(descriptor_, buffer_.data() + done, buffer_.size() - done, MSG_DONTWAIT | MSG_NOSIGNAL);
    } else {
      pollfd poll_one{descriptor_, POLLOUT, 0};
      if (::poll(&poll_one, 1, 0) != 1) break;
      sent =
          ::write(descriptor_, buffer_.data() + done, std::min<std::size_t>(buffer_.size() - done, PIPE_BUF));
    }
    if (sent > 0) {
      done += static_cast<std::size_t>(sent);
    } else if (sent < 0 && errno == EINTR) {
      continue;
    } else if (sent < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) {
      break;
    } else {
      gone_ = true;
    }
  }
  sent_bytes_ += done;
  buffer_.erase(buffer_.begin(), buffer_.begin() + static_cast<std::ptrdiff_t>(done));
}

bool BoundedWriter::write(std::string_view line) {
  if (is_file_) {
    gone_ = gone_ || write_whole(descriptor_, line) != 0;
    sent_bytes_ += gone_ ? 0 : line.size();
    return !gone_;
  }
  send_some();
  if (buffer_.size() + line.size() > capacity_) {
    ++dropped_;
  } else {
    buffer_.insert(buffer_.end(), line.begin(), line.end());
    send_some();
  }
  return !gone_;
}

void BoundedWriter::drain(int timeout_ms) {
  for (int waited = 0; !buffer_.empty() && !gone_ && waited <= timeout_ms; waited += 10) {
    pollfd poll_one{descriptor_, POLLOUT, 0};
    ::poll(&poll_one, 1, 10);
    send_some();
  }
}

}  // namespace plvo
