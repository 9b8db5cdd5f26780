// SPDX-License-Identifier: Apache-2.0
// Runs an odometry with a map on frames whose true poses are known, and compares every loop of the map with
// the truth.
#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "plvo/map/map.hpp"
#include "plvo/odometry/odometry.hpp"
#include "plvo/simulator/simulator_options.hpp"

namespace plvo::bench {

// A loop farther from the truth than this is wrong, as in tests/accuracy/look_alike_test.cpp.
inline constexpr double kWrongLoop_m = 0.15, kWrongLoop_rad = 0.1;

// Ends the program with the message of a failure: a study has no use for a part of its figures.
void need(const Status& status);

// A simulated camera of this width in pixels, 4:3, with the field of view of the default one.
SimulatorOptions simulated(SceneName scene, LightName light, std::uint64_t seed, int width, int frames);

// (t, angle) between an estimate of a pose and the truth.
struct PoseError {
  double m = 0, rad = 0;
  bool wrong() const { return m > kWrongLoop_m || rad > kWrongLoop_rad; }
};
PoseError pose_error(const Se3& estimate, const Se3& truth);

// An odometry and a map, each in a block of its own.
class MappedOdometry {
 public:
  MappedOdometry(const CameraModel& camera, int keyframes);

  Odometry odometry;
  Map map;

 private:
  std::vector<std::byte> memory_, map_memory_;
};

class MapEvaluation : public MappedOdometry {
 public:
  MapEvaluation(const CameraModel& camera, int keyframes);

  // Tracks a frame; T_world_camera is the truth.
  void see(const RgbdFrame& frame, const Se3& T_world_camera);
  // Tracks a black frame without depth, as with a hand over the lens.
  void see_nothing(std::int64_t stamp_ns);
  // To be called at the end of a sequence: the map finishes its work.
  void settle();

  // The map as a file, and back. After loading, the odometry starts anew with an unknown place in the map.
  std::vector<std::byte> save();
  void load(const std::vector<std::byte>& file);
  // Forgets the loops that were judged so far, not the places of the keyframes.
  void forget_loops() { loops_.clear(); }

  TrackResult result;
  MapResult in_map;

  // The error of each loop that the map accepted.
  const std::vector<PoseError>& loops() const { return loops_; }
  int wrong_loops() const;
  int lost() const { return lost_; }
  // CPU time of the odometry and of the map for each frame, ms.
  const std::vector<double>& track_ms() const { return track_ms_; }
  const std::vector<double>& map_ms() const { return map_ms_; }

  // The poses by odometry, by the map and by the truth, for all frames that have a place in the map now.
  struct Poses {
    std::vector<Se3> odometry, map, truth;
    std::size_t frames = 0;  // with a pose of the odometry
  };
  Poses poses() const;

 private:
  struct Frame {
    std::uint32_t keyframe = 0;
    Se3 T_keyframe_camera, T_world_camera, truth;
  };
  void update();
  void judge_loops();
  void note_loops();

  CameraModel camera_;
  std::vector<std::uint8_t> black_;
  std::vector<std::uint16_t> no_depth_;
  std::map<std::int64_t, Se3> truth_;       // of frames by their stamps
  std::map<std::uint32_t, Se3> keyframes_;  // truth of the map's keyframes by their ids
  std::set<std::pair<std::uint32_t, std::uint32_t>> known_loops_;
  std::vector<PoseError> loops_;
  std::vector<Frame> frames_;
  std::map<std::uint32_t, std::pair<std::uint32_t, Se3>> removed_;
  std::vector<double> track_ms_, map_ms_;
  int lost_ = 0;
};

}  // namespace plvo::bench
