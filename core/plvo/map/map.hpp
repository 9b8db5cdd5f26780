// SPDX-License-Identifier: Apache-2.0
// A map of the places that the camera has seen, in fixed memory, beside the odometry:
//
//   plvo::Map map;
//   map.init(memory, camera, config, plvo::MapLimits());      // plvo::Map::required_bytes(...) bytes
//   const plvo::TrackResult result = odometry.track(frame);
//   const plvo::MapResult in_map = map.update(odometry, result);
//   in_map.T_map_world * result.T_world_camera                 // the camera in the map
//
// The odometry's pose stays as it is; T_map_world takes the corrections (as odom and map in ROS REP 105).
//
// A keyframe of the odometry becomes one of the map (map_keyframe.hpp), unless its view is nearly that of the
// one before. It is compared with those that look alike (place_index.hpp) by the estimator (loop_check.hpp),
// one for each frame and, while the place is unknown, one more for each 320×240 pixels of the image. A place
// is recognised when several comparisons agree on one motion, none contradicts them, and the motion lies
// within the uncertainty of the map. The loops then join the pose graph (pose_graph.hpp), which is solved in
// steps, one for each frame. When the map is full, a keyframe is removed whose view another one shows as
// well; the only view of a place stays.
//
// Like the odometry, a map takes all memory at init, allocates nothing, and gives the same bits everywhere.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "plvo/base/arena.hpp"
#include "plvo/base/status.hpp"
#include "plvo/map/loop_check.hpp"
#include "plvo/map/map_file.hpp"
#include "plvo/map/map_keyframe.hpp"
#include "plvo/map/map_limits.hpp"
#include "plvo/map/place_index.hpp"
#include "plvo/map/pose_graph.hpp"
#include "plvo/odometry/odometry.hpp"

namespace plvo {

struct MapResult {
  // Whether the map knows where the camera is. After load(), and in another world of the odometry
  // (TrackResult::world), it does not until a place is recognised; T_map_world has no meaning until then.
  bool located = false;
  Se3 T_map_world;
  // Covariance of the ⊞-perturbation of T_map_world · T_world_camera, in the axes of the map. After a motion
  // that the odometry did not observe it is large until a place is recognised.
  Matrix6 pose_covariance = Matrix6::Zero();
  // The latest keyframe (0: there is none yet) and the pose of the camera relative to it. Composed with
  // keyframe_pose() at a later time, it gives this past pose with the corrections that were made since.
  std::uint32_t keyframe = 0;
  Se3 T_keyframe_camera;
  bool recognised = false;  // a place, in this frame
  // A keyframe that was removed in this frame, and its pose relative to one that stays.
  std::uint32_t removed = 0, removed_into = 0;
  Se3 T_into_removed;
};

// What init allocates; an arena without memory counts the bytes.
struct MapMemory {
  // Another keyframe with nearly the same view.
  struct Neighbour {
    static constexpr float kUnknown = 1e9F;
    float distance = kUnknown;
    std::uint16_t slot = 0;
  };
  MapFeatureStore features;
  PlaceIndex index;
  PoseGraph graph;
  // By slot:
  std::span<Neighbour> neighbours;
  std::span<float> depths;           // median depth of the points
  std::span<std::uint8_t> excluded;  // from the query

  constexpr void allocate(Arena& memory, const MapLimits& limits) {
    const auto n = static_cast<std::size_t>(limits.keyframes);
    features.allocate(memory, limits);
    index.allocate(memory, limits);
    graph.allocate(memory, limits.keyframes);
    neighbours = memory.take<Neighbour>("map", n);
    depths = memory.take<float>("map", n);
    excluded = memory.take<std::uint8_t>("map", n);
  }
};

class Map {
 public:
  // Bytes that init needs, whatever the alignment of the block. width, height: of the camera's image.
  static constexpr std::size_t required_bytes(const MapLimits& limits, int width, int height) {
    Arena sizer = Arena::counting();
    MapMemory().allocate(sizer, limits);
    LoopCheck::reserve(sizer, limits, width, height);
    return sizer.peak() + kArenaAlignment;
  }
  // Bytes of one more keyframe; the tables of the index grow in powers of two, up to this.
  static constexpr std::size_t kKeyframeBytes = 24 * 1024;

  // config: that of the odometry.
  Status init(std::span<std::byte> memory, const CameraModel& camera, const Config& config,
              const MapLimits& limits);

  // To be called with the result of a frame right after Odometry::track(). Does a bounded part of the pending
  // work.
  MapResult update(const Odometry& odometry, const TrackResult& result);

  // Does all pending work, however long it takes; for the end of a recording. Returns whether a place was
  // recognised.
  bool settle();

  // Calls settle(), then writes the map. kNotFound: it holds no keyframe yet. map_file.hpp has the format.
  Status save(ByteSink& sink);
  // Bytes that save() writes. It is exact after settle(), which may add loops.
  std::size_t saved_bytes() const;
  // Replaces the map by a saved one. With the same limits it then gives the same bits as the map that was
  // saved. The camera is not located until it recognises a place; its keyframes join the same graph.
  // Not ok(): the map is empty, and the message says why. kOutOfMemory: these MapLimits hold less.
  Status load(ByteSource& source);

  const PoseGraph& graph() const { return memory_.graph; }
  MapFeatures features(std::size_t slot) const { return memory_.features.at(slot); }
  // MapResult::located of the latest frame, updated by what settle() has found since.
  bool located() const { return follows_camera_ && memory_.graph.is_placed(memory_.graph.last()); }
  // The pose of a keyframe as it is known now; nothing if it was removed, or if its place in the map is not
  // known.
  std::optional<Se3> keyframe_pose(std::uint32_t id) const;

  // Counts since init: keyframes that joined, pairs that were compared, pairs that the comparison accepted,
  // and loops that joined the graph.
  struct Counts {
    int keyframes = 0, compared = 0, accepted = 0, loops = 0, removed = 0;
  };
  const Counts& counts() const { return counts_; }

 private:
  void clear();
  // map_file.cpp
  MapFileInfo file_info() const;
  Status fits(const MapFileInfo& info) const;
  void write_keyframe(std::uint16_t slot, MapWriter& writer);
  bool read_keyframe(const MapFileInfo& info, MapReader& reader);
  bool read_loop(const MapFileInfo& info, MapReader& reader);
  void find_all_neighbours();

  // A pair of keyframes that the comparison accepted.
  struct Hypothesis {
    std::uint16_t old_slot = 0, new_slot = 0;
    LoopMeasurement loop;
    bool joined = false;  // the graph
  };
  // Candidates by votes; views near a hypothesis that are added at a time.
  static constexpr std::size_t kVotedCandidates = 7, kMoreCandidates = 3,
                               kCandidates = kVotedCandidates + kMoreCandidates;
  static constexpr std::size_t kHypotheses = 24;

  void see_keyframe(const KeyframeView& view, const TrackResult& result, MapResult& out);
  void add_keyframe(const KeyframeView& view, MapResult& out);
  void continue_work(const KeyframeView& view, MapResult& out);
  bool shows_the_latest_view() const;
  bool is_recent(std::uint16_t slot) const;
  bool was_just_recognised() const;
  bool is_in_use(std::uint16_t slot) const;
  std::uint16_t least_needed() const;
  void remove(std::uint16_t slot, MapResult& out);
  bool place_is_known(std::uint16_t slot) const;
  void find_candidates(std::uint16_t slot);
  void drop_candidate(std::uint16_t slot);
  void search_on(MapResult& out);
  void compare_next();
  bool plausible(const Hypothesis& hypothesis) const;
  enum class Relation : std::uint8_t { kAgree, kContradict, kUnrelated };
  Relation compare(const Hypothesis& a, const Hypothesis& b) const;
  Matrix6 between(std::uint16_t a, std::uint16_t b) const;
  void judge(MapResult& out);
  std::span<const Hypothesis> hypotheses() const { return std::span(hypotheses_).first(hypothesis_count_); }
  const Hypothesis* best_hypothesis() const;
  void keep(const Hypothesis& hypothesis);
  bool may_suffice() const;
  Se3 pose_after(const Hypothesis& hypothesis) const;
  void look_further();
  void add_views_near(const Se3& T_map_camera, std::uint32_t part, float depth_m);
  float view_distance(std::uint16_t a, std::uint16_t b) const;
  void find_neighbour(std::uint16_t slot);
  void measure_depth(std::uint16_t slot);
  std::span<const Descriptor> all_descriptors() const { return memory_.features.all_descriptors(); }

  Arena arena_;
  LoopCheck check_;
  MapMemory memory_;
  std::size_t refreshed_ = 0;  // the position whose neighbour is searched next

  bool follows_camera_ = false;         // a keyframe of this world has joined
  std::uint32_t world_ = 0;             // of the odometry
  std::int64_t keyframe_stamp_ns_ = 0;  // of the latest keyframe
  // The latest keyframe has a rolling shutter, and its velocity is known better after the next frame.
  bool refines_velocity_ = false;
  // The latest keyframe of the odometry. If its view is new, it is the latest one of the map.
  struct Seen {
    std::int64_t stamp_ns = 0;
    Se3 T_world_camera;  // as the odometry has it now
    Matrix6 world_covariance = Matrix6::Zero();
    // Motion from the latest keyframe of the map, and its covariance.
    Se3 T_keyframe_camera;
    Matrix6 covariance = Matrix6::Zero();
  } seen_;
  // Covariance of the motion since the keyframe that was recognised last, in the axes of the map, and the
  // generalised variance of its loop (0: there is none). While the motion is more certain than a loop, a
  // known place is not searched.
  Matrix6 since_loop_ = Matrix6::Zero();
  double loop_variance_ = 0;
  std::uint16_t searched_ = 0;                          // the keyframe whose place is searched
  std::array<PlaceCandidate, kCandidates> candidates_;  // for it, the next to compare last
  std::size_t candidate_count_ = 0;
  std::size_t to_compare_ = 0;  // of them, before the next judgement
  bool is_promising_ = false;   // a hypothesis was found since the last candidates were chosen
  bool is_searching_ = false;   // for the place of searched_
  std::array<Hypothesis, kHypotheses> hypotheses_;  // the latest, oldest first
  std::size_t hypothesis_count_ = 0;
  Counts counts_;
  bool ready_ = false;
};

}  // namespace plvo
