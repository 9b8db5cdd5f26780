// SPDX-License-Identifier: Apache-2.0
// The live view: one page over HTTP, for several viewers at once. A viewer asks for what is newer than what
// it has (long polling), so a slow one gets fewer updates and a vanished one none; the odometry never notices
// either. Images are encoded once for all viewers, on the server's threads, and only while somebody looks.
// The network is not trusted: names, sizes, times and numbers of connections are limited (SECURITY.md).
#pragma once

#include <cstdint>
#include <memory>
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

  // False where plvo was built without the HTTP library; then start() says which package to install.
  static bool available();

  // Serves on host:port (0: a free one) from threads of its own, under the names of host_names.hpp;
  // names: more of them, each HostNames::is_valid. kBusy, kPermission or kInvalidArgument for an address that
  // cannot be had. Once only.
  Status start(const std::string& host, int port, const std::vector<std::string>& names = {});
  void stop();
  int port() const;

  // On the odometry's thread, once a frame. Never waits; copies nothing while nobody looks, and at most
  // kMaxRate images a second.
  static constexpr int kMaxRate = 16;
  void publish(const RgbdFrame& frame, const FeatureView& features, const TrackResult& result,
               const ViewStatus& status, bool lens_is_straight);
  // When there is no frame to show: the status alone.
  void publish_status(const ViewStatus& status);

  int viewers() const;              // that asked within the last seconds
  int connections() const;          // now, those of strangers too
  std::uint64_t images() const;     // of those published, taken for the viewers
  std::uint64_t replies() const;    // with news in them
  std::uint64_t encodings() const;  // images encoded, however many viewers got them

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace plvo
