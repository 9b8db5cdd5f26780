// SPDX-License-Identifier: Apache-2.0
#include "plvo/view/host_names.hpp"

#include <arpa/inet.h>
#include <ifaddrs.h>
#include <netinet/in.h>
#include <unistd.h>

#include <algorithm>
#include <array>

#include "plvo/host/number_text.hpp"
#include "plvo/host/stream/tcp_listener.hpp"

namespace plvo {
namespace {

char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

std::string lowered(std::string_view text) {
  std::string result(text);
  std::transform(result.begin(), result.end(), result.begin(), lower);
  return result;
}

// Returns the position of the port with its colon, or the end if there is none.
std::size_t port_at(std::string_view name) {
  const std::size_t bracket = name.rfind(']');
  const std::size_t colon = name.find(':', bracket == std::string_view::npos ? 0 : bracket);
  return std::min(colon, name.size());
}

std::vector<std::string> addresses_of_this_machine() {
  std::vector<std::string> found;
  ifaddrs* first = nullptr;
  if (::getifaddrs(&first) != 0) return found;
  for (const ifaddrs* one = first; one != nullptr; one = one->ifa_next) {
    if (one->ifa_addr == nullptr) continue;
    std::array<char, INET6_ADDRSTRLEN> text{};
    const int family = one->ifa_addr->sa_family;
    const void* bytes =
        family == AF_INET ? static_cast<const void*>(&reinterpret_cast<sockaddr_in*>(one->ifa_addr)->sin_addr)
        : family == AF_INET6 ? &reinterpret_cast<sockaddr_in6*>(one->ifa_addr)->sin6_addr
                             : nullptr;
    if (bytes != nullptr && ::inet_ntop(family, bytes, text.data(), text.size()) != nullptr) {
      found.push_back(with_brackets(text.data()));
    }
  }
  ::freeifaddrs(first);
  return found;
}

}  // namespace

bool HostNames::is_valid(std::string_view name) {
  const std::string_view host = name.substr(0, port_at(name));
  if (host.size() < name.size()) {
    const std::string_view digits = name.substr(host.size() + 1);
    int port = 0;
    if (!parse_whole_text(digits, port) || port < 1 || port > 65535) return false;
  }
  if (host.size() > 2 && host.front() == '[' && host.back() == ']') {
    in6_addr address{};
    return ::inet_pton(AF_INET6, std::string(host.substr(1, host.size() - 2)).c_str(), &address) == 1;
  }
  return !host.empty() && std::all_of(host.begin(), host.end(), [](char c) {
    return (lower(c) >= 'a' && lower(c) <= 'z') || (c >= '0' && c <= '9') || c == '.' || c == '-' || c == '_';
  });
}

HostNames::HostNames(const std::string& asked, const std::string& bound, int port,
                     const std::vector<std::string>& extra)
    : port_(port), every_address_(bound == "0.0.0.0" || bound == "::") {
  const bool loopback = is_loopback(bound);
  if (!every_address_) {
    add(with_brackets(bound));
    add(with_brackets(asked));
  }
  if (loopback || every_address_) {
    for (const char* name : {"localhost", "127.0.0.1", "[::1]"}) add(name);
  }
  if (!loopback) {
    std::array<char, 256> name{};
    if (::gethostname(name.data(), name.size() - 1) == 0 && name[0] != '\0') add(name.data());
  }
  for (const std::string& name : extra) add(name);
}

// A browser omits a default port from the header: 80, or 443 if a proxy adds TLS.
void HostNames::add(std::string name) {
  name = lowered(name);
  const std::size_t colon = port_at(name);
  if (colon == name.size()) name += ':' + std::to_string(port_);
  const std::string port = name.substr(colon);
  if (port == ":80" || port == ":443") names_.insert(name.substr(0, colon));
  names_.insert(std::move(name));
}

bool HostNames::allows(std::string_view header) const {
  const std::string name = lowered(header);
  if (names_.count(name) != 0) return true;
  if (!every_address_) return false;
  // The addresses of the machine may change while the program runs, so ask for them each time.
  const std::vector<std::string> addresses = addresses_of_this_machine();
  return std::any_of(addresses.begin(), addresses.end(), [&](const std::string& address) {
    return name == address + ':' + std::to_string(port_) || (port_ == 80 && name == address);
  });
}

}  // namespace plvo
