// SPDX-License-Identifier: Apache-2.0
// Poses as newline JSON (pose_json.hpp) for any number of readers: over TCP, over a Unix socket, or on a
// descriptor such as standard output. Nobody is waited for: each reader has a bounded buffer, loses whole
// lines when it does not keep up, and is forgotten when it goes. No thread: readers are let in when a pose is
// written.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "plvo/base/status.hpp"
#include "plvo/hal/pose_sink.hpp"
#include "plvo/host/bounded_writer.hpp"

namespace plvo {

class PoseStream final : public PoseSink {
 public:
  static constexpr std::size_t kMaxReaders = 16;
  static constexpr std::size_t kBufferBytes = 64 * 1024;  // of one reader: about two seconds of poses

  PoseStream() = default;
  ~PoseStream();
  PoseStream(const PoseStream&) = delete;
  PoseStream& operator=(const PoseStream&) = delete;

  // address: "7777" or "127.0.0.1:7777" or "[::1]:7777" (TCP; the loopback unless an address is given),
  // "unix:/path" (a socket that nobody listens on any more is replaced), or "-" (standard output).
  // kInvalidArgument for nonsense, kBusy when somebody else listens there, kPermission, kIo.
  Status open(const std::string& address);

  Status write(const TrackResult& result) override;
  // Gives the readers a moment for their last lines, and closes.
  void close();

  std::size_t readers() const { return readers_.size(); }
  std::uint64_t dropped_lines() const;
  int port() const { return port_; }  // of TCP; tells which one the system chose for port 0

 private:
  Status listen_tcp(const std::string& address);
  Status listen_unix(const std::string& path);
  void let_in();

  int listener_ = -1;
  int port_ = 0;
  std::string unix_path_;
  std::vector<BoundedWriter> readers_;
  std::uint64_t dropped_by_gone_ = 0;
};

// "[ADDR:]PORT" into its parts; false for nonsense. Without an address: "127.0.0.1".
bool split_address(const std::string& text, std::string& host, int& port);

}  // namespace plvo
