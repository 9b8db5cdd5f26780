// SPDX-License-Identifier: Apache-2.0
#include "plvo/host/stream/pose_stream.hpp"

#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "plvo/host/stream/tcp_listener.hpp"

namespace plvo {
namespace {

constexpr int kBacklog = 64;
// Less than the kernel's own choice: what it holds for a reader that does not read hides that it does not.
constexpr int kKernelBufferBytes = 32 * 1024;

}  // namespace

PoseStream::~PoseStream() { close(); }

void PoseStream::close() {
  readers_.close();
  if (listener_ >= 0) ::close(listener_);
  listener_ = -1;
  if (!unix_path_.empty()) ::unlink(unix_path_.c_str());
  unix_path_.clear();
}

Status PoseStream::open(const std::string& address) {
  close();
  if (address == "-") {
    readers_.add_borrowed(STDOUT_FILENO);
    return {};
  }
  if (address.rfind("unix:", 0) == 0) return open_unix(address.substr(5));
  return open_tcp(address);
}

Status PoseStream::open_tcp(const std::string& address) {
  std::string host;
  int port = 0;
  if (!split_address(address, host, port)) {
    return Status(StatusCode::kInvalidArgument, "a pose stream is [ADDRESS:]PORT, unix:PATH or -, not '")
        .append(address)
        .append("'");
  }
  TcpListener listener;
  if (Status status = listen_tcp(host, port, kBacklog, listener); !status.ok()) return status;
  listener_ = listener.descriptor;
  port_ = listener.port;
  return {};
}

Status PoseStream::open_unix(const std::string& path) {
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
    result = ::listen(listener_, kBacklog);
  }
  if (result != 0) {
    const int error = errno;
    close();
    return listen_error(path, error);
  }
  return {};
}

void PoseStream::let_in() {
  while (listener_ >= 0) {
    sockaddr_storage peer{};
    socklen_t size = sizeof peer;
    const int reader =
        ::accept4(listener_, reinterpret_cast<sockaddr*>(&peer), &size, SOCK_NONBLOCK | SOCK_CLOEXEC);
    if (reader < 0) return;
    const int on = 1;
    if (unix_path_.empty()) ::setsockopt(reader, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    ::setsockopt(reader, SOL_SOCKET, SO_SNDBUF, &kKernelBufferBytes, sizeof kKernelBufferBytes);
    readers_.add_socket(reader, machine_of(reinterpret_cast<const sockaddr&>(peer)));
  }
}

Status PoseStream::write_line(std::string line) {
  readers_.write(line += '\n');
  if (listener_ < 0 && readers_.count() == 0) {
    return {StatusCode::kIo, "standard output was closed: the pose stream ends"};
  }
  return {};
}

Status PoseStream::write(const TrackResult& result, const MapPose* map) {
  let_in();
  return readers_.count() == 0 ? Status() : write_line(pose_json(result, frames_, map));
}

Status PoseStream::write_heartbeat(const Heartbeat& heartbeat) {
  let_in();
  return readers_.count() == 0 ? Status() : write_line(heartbeat_json(heartbeat));
}

}  // namespace plvo
