// SPDX-License-Identifier: Apache-2.0
// Poses as newline JSON (pose_json.hpp) for any number of readers: over TCP, over a Unix socket, or on a
// descriptor such as standard output. Nobody is waited for: each reader has a bounded buffer, loses whole
// lines when it does not keep up, and is forgotten when it goes. No thread: readers are let in when a line is
// written. Who has a place, and who yields it: pose_readers.hpp.
#pragma once

#include <cstdint>
#include <string>

#include "plvo/base/status.hpp"
#include "plvo/hal/pose_sink.hpp"
#include "plvo/host/stream/pose_json.hpp"
#include "plvo/host/stream/pose_readers.hpp"

namespace plvo {

class PoseStream final : public PoseSink {
 public:
  // frames: of the results that write() is given.
  explicit PoseStream(const FrameNames& frames = kCameraFrames) : frames_(frames) {}
  ~PoseStream();
  PoseStream(const PoseStream&) = delete;
  PoseStream& operator=(const PoseStream&) = delete;

  // address: "7777" or "127.0.0.1:7777" or "[::1]:7777" (TCP; the loopback unless an address is given),
  // "unix:/path" (a socket that nobody listens on any more is replaced), or "-" (standard output).
  // kInvalidArgument for nonsense, kBusy when somebody else listens there, kPermission, kIo.
  Status open(const std::string& address);

  Status write(const TrackResult& result) override { return write(result, nullptr); }
  // map: nullptr without one.
  Status write(const TrackResult& result, const MapPose* map);
  // When there is no pose to tell: pose_json.hpp, heartbeat_json(). kIo as above.
  Status write_heartbeat(const Heartbeat& heartbeat);
  // Gives the readers a moment for their last lines, and closes.
  void close();

  std::size_t readers() const { return readers_.count(); }
  std::uint64_t dropped_lines() const { return readers_.dropped_lines(); }
  int port() const { return port_; }  // of TCP; tells which one the system chose for port 0

 private:
  Status open_tcp(const std::string& address);
  Status open_unix(const std::string& path);
  void let_in();
  Status write_line(std::string line);

  FrameNames frames_;
  int listener_ = -1;
  int port_ = 0;
  std::string unix_path_;
  PoseReaders readers_;
};

}  // namespace plvo
