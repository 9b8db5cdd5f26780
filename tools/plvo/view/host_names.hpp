// SPDX-License-Identifier: Apache-2.0
// Under which names the live view answers. A page from anywhere may send the user's browser here under a name
// of its own that resolves to this machine (DNS rebinding), and would see the camera as if it were its own:
// the Host header gives it away, so that only names which this machine really has are answered, compared to
// the last character, port included.
#pragma once

#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace plvo {

class HostNames {
 public:
  // "NAME" or "NAME:PORT" as it may stand in a Host header: letters, digits, dots, hyphens and underscores,
  // or an IPv6 address in brackets.
  static bool is_valid(std::string_view name);

  // asked: the address as the user gave it; bound: what the system made of it, as numbers; extra: names that
  // lead here by way of others (a proxy, a tunnel, the mDNS name), each for `port` unless it brings one.
  //
  // Bound to the loopback these are localhost, 127.0.0.1, [::1] and the bound address; to another address it
  // and the machine's host name; to all addresses all of those and whatever address the machine has at the
  // moment.
  HostNames(const std::string& asked, const std::string& bound, int port,
            const std::vector<std::string>& extra);

  // header: the value of the Host header; upper and lower case are the same.
  bool allows(std::string_view header) const;

 private:
  void add(std::string name);

  std::set<std::string> names_;  // lower case, with the port
  int port_;
  bool every_address_;
};

}  // namespace plvo
