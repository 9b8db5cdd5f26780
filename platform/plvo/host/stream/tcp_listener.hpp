// SPDX-License-Identifier: Apache-2.0
// A TCP port to listen on, named as on the command line: [ADDRESS:]PORT. Whoever gives no address stays on
// the loopback.
#pragma once

#include <sys/socket.h>

#include <string>

#include "plvo/base/status.hpp"

namespace plvo {

// "[ADDR:]PORT" into its parts; false for nonsense. Without an address: "127.0.0.1".
bool split_address(const std::string& text, std::string& host, int& port);
// The host as it stands before a port: an IPv6 address in brackets, once.
std::string with_brackets(const std::string& host);

// True for a host that only this machine can reach: "localhost", 127.0.0.0/8 or ::1, with or without
// brackets. A name that merely begins like one of them is not.
bool is_loopback(const std::string& host);

struct TcpListener {
  int descriptor = -1;  // listens, does not block; whoever asked for it closes it
  int port = 0;         // tells which one the system chose for port 0
  std::string address;  // that was bound, as numbers without brackets
};

// kInvalidArgument for an address that does not exist, kBusy when somebody else listens there, kPermission,
// kIo.
Status listen_tcp(const std::string& host, int port, int backlog, TcpListener& listener);

// Who is at the other end, as numbers and without the port: what a share of the places is counted by. A
// machine may have a whole network of IPv6 addresses, which stands for it then (its first 64 bits). Empty for
// others.
std::string machine_of(const sockaddr& peer);

// What listening on `address` failed with, by errno.
Status listen_error(const std::string& address, int error);

}  // namespace plvo
