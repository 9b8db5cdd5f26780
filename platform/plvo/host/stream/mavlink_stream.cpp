// SPDX-License-Identifier: Apache-2.0
#include "plvo/host/stream/mavlink_stream.hpp"

#include <netdb.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "plvo/host/stream/tcp_listener.hpp"

namespace plvo {

MavlinkStream::~MavlinkStream() {
  if (socket_ >= 0) ::close(socket_);
}

Status MavlinkStream::open(const std::string& address) {
  std::string host;
  int port = 0;
  if (!split_address(address, host, port))
    return Status(StatusCode::kInvalidArgument, "MAVLink goes to [HOST:]PORT, not to '")
        .append(address)
        .append("'");
  addrinfo hints{};
  hints.ai_socktype = SOCK_DGRAM;
  hints.ai_flags = AI_NUMERICSERV;
  addrinfo* found = nullptr;
  if (const int error = ::getaddrinfo(host.c_str(), std::to_string(port).c_str(), &hints, &found); error != 0)
    return Status(StatusCode::kInvalidArgument, "no such address: ")
        .append(host)
        .append(": ")
        .append(gai_strerror(error));
  socket_ = ::socket(found->ai_family, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  const bool connected = socket_ >= 0 && ::connect(socket_, found->ai_addr, found->ai_addrlen) == 0;
  const int error = errno;
  ::freeaddrinfo(found);
  if (connected) return {};
  return Status(StatusCode::kIo, "cannot send to ").append(address).append(": ").append(std::strerror(error));
}

Status MavlinkStream::write(const TrackResult& result) {
  if (!is_open()) return {};
  if (const auto message = odometry_.message(result))
    (void)::send(socket_, message->data(), message->size(), MSG_DONTWAIT | MSG_NOSIGNAL);
  return {};
}

}  // namespace plvo
