// SPDX-License-Identifier: Apache-2.0
// Between the odometry and the viewers: three snapshots that change hands under a mutex held for a few
// instructions, one encoding per image, and a reply for each viewer that holds only what it does not have
// yet.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>

#include "plvo/view/view_state.hpp"

namespace plvo {

class ViewHub {
 public:
  // What a viewer says it has.
  struct Ask {
    std::uint64_t after = 0;  // sequence
    std::uint64_t image = 0;  // image sequence
    std::uint64_t path_epoch = ~std::uint64_t{0};
    std::size_t path_points = 0;
    std::string viewer;  // any word that tells viewers apart
  };

  // The odometry's thread; see ViewServer.
  void publish(const RgbdFrame& frame, const FeatureView& features, const TrackResult& result,
               const ViewStatus& status, bool lens_is_straight);
  void publish_status(const ViewStatus& status);

  // Called after each publication with news in it, on the publisher's thread: must not wait. Set before the
  // first publication.
  void on_news(std::function<void()> call) { on_news_ = std::move(call); }
  // Somebody looks: from now on, for some seconds, images are taken.
  void count_viewer(const Ask& ask);
  // Whether there is something that this viewer does not have.
  bool has_news(const Ask& ask) const;
  // Three parts, each behind its length (32 bits, little-endian): JSON, the camera's JPEG, the depth's JPEG
  // (empty where the viewer has that image already). An empty string means no news.
  std::string reply(const Ask& ask);

  int viewers() const;
  std::uint64_t images() const;  // taken for the viewers
  std::uint64_t replies() const { return replies_; }
  std::uint64_t encodings() const { return encodings_; }

 private:
  struct Encoded {
    std::uint64_t image = 0;
    int width = 0, height = 0;
    std::string colour, depth;                               // JPEG
    std::string features = "\"points\":[],\"segments\":[]";  // JSON members
  };
  std::shared_ptr<const Encoded> encoded();
  std::string state_json(const Ask& ask, std::uint64_t sequence, const Encoded& image);

  mutable std::mutex mutex_;  // all of the following; never held while copying images or encoding
  std::array<ViewSnapshot, 3> snapshots_;
  int back_ = 0, middle_ = 1, front_ = 2;  // written by the odometry; newest whole one; read by the encoder
  bool middle_is_new_ = false;
  std::uint64_t sequence_ = 0;
  std::uint64_t image_sequence_ = 0;
  TrackResult result_;
  ViewStatus status_;
  ViewPath path_;
  std::map<std::string, std::int64_t> seen_;  // viewer → when it asked last

  std::function<void()> on_news_ = [] {};
  std::atomic<std::int64_t> last_ask_ns_{-1'000'000'000'000};
  std::int64_t last_image_ns_ = 0;
  std::atomic<std::uint64_t> replies_{0};
  std::atomic<std::uint64_t> encodings_{0};

  std::mutex encode_mutex_;  // one encoder at a time; guards front_'s pixels and the following
  std::shared_ptr<const Encoded> encoded_ = std::make_shared<Encoded>();
};

}  // namespace plvo
