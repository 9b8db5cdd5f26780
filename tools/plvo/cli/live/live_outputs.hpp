// SPDX-License-Identifier: Apache-2.0
// Everything that `plvo live` tells while it runs: files, pose streams, the live view. None of them may hold
// the odometry up or end it: a full disk ends the files alone.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "plvo/cli/common/console.hpp"
#include "plvo/cli/common/frame_record.hpp"
#include "plvo/cli/map/session_map.hpp"
#include "plvo/cli/run/run_outputs.hpp"
#include "plvo/host/stream/pose_stream.hpp"
#include "plvo/odometry/odometry.hpp"
#include "plvo/view/view_server.hpp"

namespace plvo::cli {

struct LiveOutputOptions {
  OutputOptions files;
  std::vector<std::string> streams;
  std::string view;                     // [ADDR:]PORT; empty: none
  std::vector<std::string> view_names;  // NAME[:PORT] beside those of the address
};

class LiveOutputs {
 public:
  static constexpr std::int64_t kHeartbeat_ns = 500'000'000;

  explicit LiveOutputs(Console& console) : console_(console) {}

  // Takes the addresses of the live view and the streams: one that is in use must not cost an old trajectory.
  Status listen(const LiveOutputOptions& options);
  // Then makes the files, and says where to look.
  Status open(const LiveOutputOptions& options, bool lens_is_straight);

  // After each frame.
  void write(const FrameRecord& record, const RgbdFrame& frame, const Odometry& odometry,
             const SessionMap& map, const ViewStatus& status);
  // While there is no frame, as often as one likes: the live view gets it four times a second; the pose
  // streams get a heartbeat whenever they have got no line for kHeartbeat_ns.
  void write_status(const ViewStatus& status, const Heartbeat& heartbeat);
  void close();

  // Something ended, and nothing is left that anybody could look at: `plvo live --stream - | head`.
  bool in_vain() const { return !failure_.ok() && streams_.empty() && !view_ && (files_end_ || !has_files_); }
  const Status& failure() const { return failure_; }  // what ended the files or the standard output
  std::uint64_t dropped_lines() const;

 private:
  Status open_view(const std::string& address, const std::vector<std::string>& names);
  Status open_stream(const std::string& address);
  void to_streams(const std::function<Status(PoseStream&)>& write);

  Console& console_;
  RunOutputs files_;
  BaseOption base_;
  bool has_files_ = false, files_end_ = false;
  std::vector<std::unique_ptr<PoseStream>> streams_;
  std::unique_ptr<ViewServer> view_;
  std::vector<Vector3> map_way_;  // for the live view
  bool lens_is_straight_ = true;
  std::int64_t next_status_ns_ = 0;
  std::int64_t next_heartbeat_ns_ = 0;
  std::vector<std::pair<LogLevel, std::string>> announcements_;  // of listen(): there may be no camera
  Status failure_;
};

}  // namespace plvo::cli
