// SPDX-License-Identifier: Apache-2.0
// Connects the odometry and the viewers: three snapshots are exchanged under a mutex that is held for a few
// instructions; each image is encoded once; a viewer's reply contains only what the viewer lacks.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "plvo/view/view_state.hpp"

namespace plvo {

class ViewHub {
 public:
  ViewHub();
  // What a viewer states that it already has.
  struct Ask {
    std::uint64_t after = 0;  // sequence number
    std::uint64_t image = 0;  // sequence number of the image
    std::uint64_t path_epoch = ~std::uint64_t{0};
    std::size_t path_points = 0;
    std::string viewer;  // any word that distinguishes viewers
  };

  // Called on the odometry's thread; see ViewServer.
  void publish(const RgbdFrame& frame, const FeatureView& features, const TrackResult& result,
               const ViewStatus& status, bool lens_is_straight);
  void publish_status(const ViewStatus& status);
  void publish_map_way(std::span<const Vector3> positions);

  // Sets the function that is called after each publication with news, on the publisher's thread; it must not
  // wait. Call it before the first publication.
  void on_news(std::function<void()> call) { on_news_ = std::move(call); }
  // Registers a viewer: from now on, for some seconds, images are copied.
  void count_viewer(const Ask& ask);
  // Returns true if there is anything that this viewer lacks.
  bool has_news(const Ask& ask) const;
  // Returns three parts, each after its length (32 bits, little-endian): JSON, the camera's JPEG, the depth's
  // JPEG (empty if the viewer already has that image). Returns an empty string if there is no news.
  std::string reply(const Ask& ask);

  int viewers() const;
  std::uint64_t images() const;  // copied for the viewers
  std::uint64_t replies() const { return replies_; }
  std::uint64_t encodings() const { return encodings_; }

 private:
  struct Encoded;
  std::shared_ptr<const Encoded> encoded();
  std::string state_json(const Ask& ask, std::uint64_t sequence, const Encoded& image);

  mutable std::mutex mutex_;  // guards the following members; never held while copying images or encoding
  std::array<ViewSnapshot, 3> snapshots_;
  int back_ = 0, middle_ = 1,
      front_ = 2;  // written by the odometry; newest complete one; read by the encoder
  bool middle_is_new_ = false;
  std::uint64_t sequence_ = 0;
  std::uint64_t image_sequence_ = 0;
  TrackResult result_;
  ViewStatus status_;
  ViewPath path_;
  std::vector<Vector3> map_way_;
  std::map<std::string, std::int64_t> seen_;  // viewer → time of its last request

  std::function<void()> on_news_ = [] {};
  std::atomic<std::int64_t> last_ask_ns_{-1'000'000'000'000};
  std::int64_t last_image_ns_ = 0;
  std::atomic<std::uint64_t> replies_{0};
  std::atomic<std::uint64_t> encodings_{0};

  std::mutex encode_mutex_;  // one encoder at a time; guards front_'s pixels and the following members
  std::shared_ptr<const Encoded> encoded_;
};

}  // namespace plvo
