// SPDX-License-Identifier: Apache-2.0
#include "map_golden_run.hpp"

#include <cstdint>

#include "fingerprint.hpp"
#include "result_fingerprint.hpp"
#include "text_line.hpp"

namespace plvo {
namespace {

constexpr int kTurn = 100;   // views to the turning point
constexpr int kCovered = 6;  // frames; too many for the odometry, so a new world begins
constexpr int kEvery = 10;   // frames of a line

class Run {
 public:
  Run(const MapGoldenMemory& memory, void (*print)(std::string_view)) : memory_(memory), print_(print) {}

  bool start() {
    if (!sequence_.init(kMapGoldenLimits.width, kMapGoldenLimits.height, memory_.frames)) return false;
    config_.references.max_lost_s = 0.06;
    return memory_.odometry.init(memory_.arena, sequence_.camera(), config_, kMapGoldenLimits).ok() &&
           memory_.map.init(memory_.map_arena, sequence_.camera(), config_, kMapGoldenMapLimits).ok();
  }

  void track(const char* name, int from, int to) {
    for (int view = from; view != to; view += from < to ? 1 : -1) see(name, sequence_.render(view));
  }
  void cover(const char* name) {
    for (int i = 0; i < kCovered; ++i) see(name, sequence_.render_dark(0));
  }

  // The fingerprints of the saved map, and of what a loaded one saves.
  bool save_and_load() {
    std::uint64_t saved[2] = {};
    std::size_t bytes = 0;
    for (std::uint64_t& print : saved) {
      SpanSink sink(memory_.file);
      if (!memory_.map.save(sink).ok()) return false;
      bytes = sink.size();
      print = fingerprint(memory_.file.first(bytes));
      SpanSource source(memory_.file.first(bytes));
      if (!memory_.map.load(source).ok()) return false;
    }
    TextLine line;
    line.text("file ").integer(static_cast<std::int64_t>(bytes));
    for (const std::uint64_t print : saved) line.space().hex(print, 16);
    print_(line.view());
    return true;
  }

 private:
  static std::uint64_t fingerprint(std::span<const std::byte> bytes) {
    Fingerprint print;
    for (const std::byte byte : bytes) print.add_byte(static_cast<std::uint8_t>(byte));
    return print.value();
  }

  void see(const char* name, RgbdFrame frame) {
    frame.stamp_ns = frame.depth_stamp_ns = ProceduralRenderer::stamp_ns(taken_);
    const TrackResult result = memory_.odometry.track(frame);
    const MapResult in_map = memory_.map.update(memory_.odometry, result);
    odometry_.add(fingerprint_of(result).value());
    map_.add(in_map.located ? 1 : 0);
    map_.add(in_map.T_map_world.R);
    map_.add(in_map.T_map_world.t);
    map_.add(in_map.pose_covariance);
    if (++taken_ % kEvery != 0) return;
    const Map::Counts& counts = memory_.map.counts();
    TextLine line;
    line.text(name).space().integer(taken_).space().text(in_map.located ? "located" : "not_located");
    for (const int count : {counts.keyframes, counts.removed, counts.compared, counts.loops})
      line.space().integer(count);
    line.space().hex(odometry_.value(), 16).space().hex(map_.value(), 16);
    print_(line.view());
  }

  MapGoldenMemory memory_;
  void (*print_)(std::string_view);
  ProceduralRenderer sequence_;
  Config config_;
  Fingerprint odometry_, map_;  // of all frames so far
  int taken_ = 0;
};

}  // namespace

bool map_golden_run(const MapGoldenMemory& memory, void (*print)(std::string_view)) {
  print("run frame state keyframes removed compared loops odometry map");
  Run run(memory, print);
  if (!run.start()) {
    print("too little memory");
    return false;
  }
  run.track("out", 0, kTurn);
  run.track("back", kTurn, 0);
  run.cover("covered");
  run.track("carried", 30, kTurn);
  if (run.save_and_load()) return true;
  print("the map cannot be saved and loaded");
  return false;
}

}  // namespace plvo
