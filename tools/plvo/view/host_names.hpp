// SPDX-License-Identifier: Apache-2.0
// The names under which the live view answers. A foreign page may direct the user's browser to this machine
// under a name of its own that resolves to it (DNS rebinding), and could then read the camera images. The
// Host header shows that name. Therefore the server answers only names that this machine has, compared
// exactly, port included.
#pragma once

#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace plvo {

class HostNames {
 public:
  // "NAME" or "NAME:PORT" as in a Host header: letters, digits, dots, hyphens and underscores, or an IPv6
  // address in brackets.
  static bool is_valid(std::string_view name);

  // asked: the address as the user gave it; bound: the numeric address that the system resolved it to; extra:
  // names that lead here indirectly (a proxy, a tunnel, the mDNS name), each for `port` unless it has its
  // own.
  //
  // Bound to the loopback interface, the names are localhost, 127.0.0.1, [::1] and the bound address. Bound
  // to another address, they are that address and the machine's host name. Bound to all addresses, they are
  // all of these and every current address of the machine.
  HostNames(const std::string& asked, const std::string& bound, int port,
            const std::vector<std::string>& extra);

  // header: the value of the Host header; case is ignored.
  bool allows(std::string_view header) const;

 private:
  void add(std::string name);

  std::set<std::string> names_;  // lower case, with the port
  int port_;
  bool every_address_;
};

}  // namespace plvo
