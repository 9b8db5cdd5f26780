// SPDX-License-Identifier: Apache-2.0
#include "plvo/host/pose_stream.hpp"

#include <arpa/inet.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>

#include "plvo/host/pose_json.hpp"

namespace plvo {
namespace {

Status socket_error(const char* what, const std::string& address, int error) {
  const StatusCode code = error == EADDRINUSE                 ? StatusCode::kBusy
                          : error == EACCES || error == EPERM ? StatusCode::kPermission
                                                              : StatusCode::kIo;
  Status status(code, what);
  status.append(" ").append(address).append(": ").append(std::strerror(error));
  if (code == StatusCode::kBusy) status.append("; choose another one, or end the program that listens there");
  return status;
}

}  // namespace

bool split_address(const std::string& text, std::string& host, int& port) {
  const std::size_t colon = text.rfind(':');
  std::string address = colon == std::string::npos ? "127.0.0.1" : text.substr(0, colon);
  const std::string digits = colon == std::string::npos ? text : text.substr(colon + 1);
  if (address.size() >= 2 && address.front() == '[' && address.back() == ']') {
    address = address.substr(1, address.size() - 2);
  } else if (address.find(':') != std::string::npos) {
    return false;  // an IPv6 address needs its brackets
  }
  int value = -1;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (address.empty() || error != std::errc() || end != digits.data() + digits.size() || value < 0 ||
      value > 65535) {
    return false;
  }
  host = address;
  port = value;
  return true;
}

PoseStream::~PoseStream() { close(); }

void PoseStream::close() {
  for (BoundedWriter& reader : readers_) reader.drain(100);
  dropped_by_gone_ = dropped_lines();
  readers_.clear();
  if (listener_ >= 0) ::close(listener_);
  listener_ = -1;
  if (!unix_path_.empty()) ::unlink(unix_path_.c_str());
  unix_path_.clear();
}

Status PoseStream::open(const std::string& address) {
  close();
  readers_.reserve(kMaxReaders);
  if (address == "-") {
    readers_.emplace_back(STDOUT_FILENO, false, false, kBufferBytes);
    return {};
  }
  if (address.rfind("unix:", 0) == 0) return listen_unix(address.substr(5));
  return listen_tcp(address);
}

Status PoseStream::listen_tcp(const std::string& address) {
  std::string host;
  int port = 0;
  if (!split_address(address, host, port)) {
    return Status(StatusCode::kInvalidArgument, "a pose stream is [ADDRESS:]PORT, unix:PATH or -, not '")
        .append(address)
        .append("'");
  }
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  hints.ai_flags = AI_NUMERICSERV | AI_PASSIVE;
  addrinfo* found = nullptr;
  if (const int error = ::getaddrinfo(host.c_str(), std::to_string(port).c_str(), &hints, &found);
      error != 0) {
    return Status(StatusCode::kInvalidArgument, "no such address: ")
        .append(host)
        .append(": ")
        .append(gai_strerror(error));
  }
  listener_ = ::socket(found->ai_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  const int on = 1;
  if (listener_ >= 0) ::setsockopt(listener_, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  const bool ok = listener_ >= 0 && ::bind(listener_, found->ai_addr, found->ai_addrlen) == 0 &&
                  ::listen(listener_, static_cast<int>(kMaxReaders)) == 0;
  const int error = errno;
  ::freeaddrinfo(found);
  if (!ok) {
    close();
    return socket_error("cannot listen on", address, error);
  }
  sockaddr_storage bound{};
  socklen_t size = sizeof bound;
  ::getsockname(listener_, reinterpret_cast<sockaddr*>(&bound), &size);
  port_ = ntohs(bound.ss_family == AF_INET6 ? reinterpret_cast<sockaddr_in6&>(bound).sin6_port
                                            : reinterpret_cast<sockaddr_in&>(bound).sin_port);
  return {};
}

Status PoseStream::listen_unix(const std::string& path) {
  sockaddr_un name{};
  name.sun_family = AF_UNIX;
  if (path.empty() || path.size() >= sizeof name.sun_path) {
    return {StatusCode::kInvalidArgument, "the path of a Unix socket has 1 to 107 characters"};
  }
  std::memcpy(name.sun_path, path.c_str(), path.size() + 1);
  const auto* address = reinterpret_cast<const sockaddr*>(&name);
  listener_ = ::socket(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  int result = listener_ < 0 ? -1 : ::bind(listener_, address, sizeof name);
  if (result != 0 && errno == EADDRINUSE) {
    // Left over from a program that ended badly? Nobody answers then. Only ever remove a socket.
    struct stat info {};
    const int probe = ::socket(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    const bool dead = ::stat(path.c_str(), &info) == 0 && S_ISSOCK(info.st_mode) &&
                      ::connect(probe, address, sizeof name) != 0 && errno == ECONNREFUSED;
    ::close(probe);
    errno = EADDRINUSE;
    if (dead && ::unlink(path.c_str()) == 0) result = ::bind(listener_, address, sizeof name);
  }
  if (result == 0) {
    unix_path_ = path;
    result = ::listen(listener_, static_cast<int>(kMaxReaders));
  }
  if (result != 0) {
    const int error = errno;
    close();
    return socket_error("cannot listen on", path, error);
  }
  return {};
}

void PoseStream::let_in() {
  while (listener_ >= 0) {
    const int reader = ::accept4(listener_, nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC);
    if (reader < 0) return;
    if (readers_.size() >= kMaxReaders) {
      ::close(reader);
      continue;
    }
    const int on = 1;
    if (unix_path_.empty()) ::setsockopt(reader, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    readers_.emplace_back(reader, true, true, kBufferBytes);
  }
}

Status PoseStream::write(const TrackResult& result) {
  let_in();
  if (readers_.empty()) return {};
  const std::string line = pose_json(result) + '\n';
  std::erase_if(readers_, [&](BoundedWriter& reader) {
    if (reader.write(line)) return false;
    dropped_by_gone_ += reader.dropped();
    return true;
  });
  if (listener_ < 0 && readers_.empty()) {
    return {StatusCode::kIo, "standard output was closed: the pose stream ends"};
  }
  return {};
}

std::uint64_t PoseStream::dropped_lines() const {
  std::uint64_t sum = dropped_by_gone_;
  for (const BoundedWriter& reader : readers_) sum += reader.dropped();
  return sum;
}

}  // namespace plvo
