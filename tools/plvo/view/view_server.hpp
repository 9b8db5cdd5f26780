// SPDX-License-Identifier: Apache-2.0
// The live view: one page over HTTP, for several viewers at once. A viewer requests what is newer than its
// own state (long polling): a slow viewer gets fewer updates, and a vanished one gets none. The odometry is
// never affected. Images are encoded once for all viewers, on the server's threads, and only while there is a
// viewer. The network is untrusted: names, sizes, times and numbers of connections are limited (SECURITY.md).
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "plvo/base/status.hpp"
#include "plvo/image/frame.hpp"
#include "plvo/odometry/odometry.hpp"
#include "plvo/view/view_state.hpp"

namespace plvo {

class ViewServer {
 public:
  ViewServer();
  ~ViewServer();
  ViewServer(const ViewServer&) = delete;
  ViewServer& operator=(const ViewServer&) = delete;

  // Returns false if plvo was built without the HTTP library; start() then names the package to install.
  static bool available();

  // Serves on host:port (0: a free port) from threads of its own, under the names of host_names.hpp; names:
  // further ones, each HostNames::is_valid. Returns kBusy, kPermission or kInvalidArgument if the address is
  // not available. Call it only once.
  Status start(const std::string& host, int port, const std::vector<std::string>& names = {});
  void stop();
  int port() const;

  // Call it on the odometry's thread, once per frame. It never waits, copies nothing without a viewer, and
  // copies at most kMaxRate images a second.
  static constexpr int kMaxRate = 16;
  void publish(const RgbdFrame& frame, const FeatureView& features, const TrackResult& result,
               const ViewStatus& status, bool lens_is_straight);
  // Where a map puts its keyframes, before publish(). It takes no memory.
  void publish_map_way(std::span<const Vector3> positions);
  // Publishes only the status when there is no frame.
  void publish_status(const ViewStatus& status);

  int viewers() const;              // that sent a request within the last seconds
  int connections() const;          // open now, of viewers and others
  std::uint64_t images() const;     // published images that were copied for the viewers
  std::uint64_t replies() const;    // with news
  std::uint64_t encodings() const;  // encoded images, regardless of the number of viewers

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace plvo
