// SPDX-License-Identifier: Apache-2.0
#include "plvo/host/stream/tcp_listener.hpp"

#include <arpa/inet.h>
#include <netdb.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>

#include "plvo/host/number_text.hpp"

namespace plvo {
namespace {

std::string without_brackets(const std::string& host) {
  const bool bracketed = host.size() >= 2 && host.front() == '[' && host.back() == ']';
  return bracketed ? host.substr(1, host.size() - 2) : host;
}

}  // namespace

bool split_address(const std::string& text, std::string& host, int& port) {
  const std::size_t colon = text.rfind(':');
  const std::string given = colon == std::string::npos ? "127.0.0.1" : text.substr(0, colon);
  const std::string digits = colon == std::string::npos ? text : text.substr(colon + 1);
  const std::string address = without_brackets(given);
  if (address == given && address.find(':') != std::string::npos) return false;  // IPv6 needs its brackets
  int value = -1;
  if (address.empty() || !parse_whole_text(digits, value) || value < 0 || value > 65535) return false;
  host = address;
  port = value;
  return true;
}

std::string with_brackets(const std::string& host) {
  return host.find(':') == std::string::npos || host.front() == '[' ? host : '[' + host + ']';
}

bool is_loopback(const std::string& host) {
  const std::string address = without_brackets(host);
  if (address == "localhost") return true;
  in_addr four{};
  if (::inet_pton(AF_INET, address.c_str(), &four) == 1) return ntohl(four.s_addr) >> 24 == 127;
  in6_addr six{};
  return ::inet_pton(AF_INET6, address.c_str(), &six) == 1 && IN6_IS_ADDR_LOOPBACK(&six);
}

std::string machine_of(const sockaddr& peer) {
  std::array<char, INET6_ADDRSTRLEN> text{};
  if (peer.sa_family == AF_INET) {
    ::inet_ntop(AF_INET, &reinterpret_cast<const sockaddr_in&>(peer).sin_addr, text.data(), text.size());
  } else if (peer.sa_family == AF_INET6) {
    in6_addr address = reinterpret_cast<const sockaddr_in6&>(peer).sin6_addr;
    if (!IN6_IS_ADDR_V4MAPPED(&address) && !IN6_IS_ADDR_LOOPBACK(&address)) {
      std::memset(address.s6_addr + 8, 0, 8);
    }
    ::inet_ntop(AF_INET6, &address, text.data(), text.size());
  }
  return text.data();
}

Status listen_error(const std::string& address, int error) {
  const StatusCode code = error == EADDRINUSE                 ? StatusCode::kBusy
                          : error == EACCES || error == EPERM ? StatusCode::kPermission
                          : error == EADDRNOTAVAIL            ? StatusCode::kInvalidArgument
                                                              : StatusCode::kIo;
  Status status(code, "cannot listen on ");
  status.append(address).append(": ").append(std::strerror(error));
  if (code == StatusCode::kBusy) status.append("; choose another one, or end the program that listens there");
  return status;
}

Status listen_tcp(const std::string& host, int port, int backlog, TcpListener& listener) {
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
  const int descriptor = ::socket(found->ai_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  const int on = 1;
  if (descriptor >= 0) ::setsockopt(descriptor, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  const bool ok = descriptor >= 0 && ::bind(descriptor, found->ai_addr, found->ai_addrlen) == 0 &&
                  ::listen(descriptor, backlog) == 0;
  const int error = errno;
  ::freeaddrinfo(found);
  if (!ok) {
    if (descriptor >= 0) ::close(descriptor);
    return listen_error(host + ":" + std::to_string(port), error);
  }
  sockaddr_storage bound{};
  socklen_t size = sizeof bound;
  ::getsockname(descriptor, reinterpret_cast<sockaddr*>(&bound), &size);
  std::array<char, NI_MAXHOST> numbers{};
  ::getnameinfo(reinterpret_cast<const sockaddr*>(&bound), size, numbers.data(), numbers.size(), nullptr, 0,
                NI_NUMERICHOST);
  listener.descriptor = descriptor;
  listener.port = ntohs(bound.ss_family == AF_INET6 ? reinterpret_cast<sockaddr_in6&>(bound).sin6_port
                                                    : reinterpret_cast<sockaddr_in&>(bound).sin_port);
  listener.address = numbers.data();
  return {};
}

}  // namespace plvo
