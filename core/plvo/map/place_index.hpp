// SPDX-License-Identifier: Apache-2.0
// Finds the keyframes of the map that look like a given one. Binary descriptors near each other agree in most
// bits. So a key of a few bits, drawn once, is often the same for both, and a table from keys to descriptors
// finds one from the other without comparing all (bit sampling: Indyk & Motwani, STOC 1998; several tables
// over different bits: Norouzi, Punjani & Fleet, CVPR 2012). It needs no training.
//
// Each descriptor of the query votes for the keyframes that have a descriptor near to it. The vote is divided
// by the number of these keyframes: a descriptor that is everywhere says nothing about the place (inverse
// document frequency: Sivic & Zisserman, ICCV 2003).
//
// The length of every list is bounded, and so is the time of each call: adding and removing a descriptor
// visit at most kListLength entries for each table; a query compares each of its descriptors with at most
// kTables · kListLength others.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "plvo/base/arena.hpp"
#include "plvo/base/fixed_vector.hpp"
#include "plvo/map/map_limits.hpp"
#include "plvo/points/keypoint.hpp"

namespace plvo {

struct PlaceCandidate {
  std::uint16_t slot = 0;
  std::uint32_t score = 0;  // kWholeVote for a descriptor that votes for this keyframe alone
  std::uint16_t votes = 0;  // descriptors that vote for this keyframe
};

class PlaceIndex {
 public:
  static constexpr std::size_t kTables = 3;
  static constexpr int kKeyBits = 14;
  static constexpr std::size_t kListLength = 24;
  static constexpr int kNear = 48;  // bits of 256 in which a descriptor that votes differs at most
  static constexpr std::uint32_t kWholeVote = 64;

  constexpr void allocate(Arena& memory, const MapLimits& limits) {
    keypoints_ = static_cast<std::size_t>(limits.keypoints);
    const std::size_t entries = static_cast<std::size_t>(limits.keyframes) * keypoints_;
    lists_ = lists(entries);
    heads_ = memory.take<std::uint32_t>("map index", kTables * lists_);
    nexts_ = memory.take<std::uint32_t>("map index", kTables * entries);
    scores_ = memory.take<std::uint32_t>("map index", static_cast<std::size_t>(limits.keyframes));
    votes_ = memory.take<std::uint16_t>("map index", static_cast<std::size_t>(limits.keyframes));
    voters_ = memory.take<std::uint32_t>("map index", static_cast<std::size_t>(limits.keyframes));
  }
  // Removes all descriptors.
  void clear();

  // `stored`: all descriptors of the map, those of slot s from s · keypoints on. The descriptors of a slot
  // must be the same when it is added and when it is removed.
  void add(std::span<const Descriptor> stored, std::size_t slot, std::size_t count);
  void remove(std::span<const Descriptor> stored, std::size_t slot, std::size_t count);

  // The tables that contain a descriptor, one bit each, for a map that is saved. A full list has lost its
  // oldest descriptors. When all descriptors are added again in the same order, the lists are the same.
  std::uint8_t tables_of(std::span<const Descriptor> stored, std::size_t entry);
  void add_to_tables(std::span<const Descriptor> stored, std::size_t entry, std::uint8_t tables);

  // Writes the keyframes with the highest scores, the best first. Of equal scores the lower slot
  // comes first. Slots with a flag in `excluded` get no vote.
  void query(std::span<const Descriptor> stored, std::span<const Descriptor> query,
             std::span<const std::uint8_t> excluded, FixedVector<PlaceCandidate>& best);

 private:
  static constexpr std::uint32_t kEnd = 0xffffffff;
  // Number of lists of a table: a power of two, one list for two to four descriptors, at most one for each
  // key.
  static constexpr std::size_t lists(std::size_t entries) {
    std::size_t n = 1;
    while (4 * n <= entries && n < (std::size_t{1} << kKeyBits)) n *= 2;
    return n;
  }
  void insert(std::size_t table, std::span<const Descriptor> stored, std::size_t entry);
  std::uint32_t& head(std::size_t table, const Descriptor& descriptor);
  std::uint32_t& next(std::size_t table, std::size_t entry) {
    return nexts_[table * (nexts_.size() / kTables) + entry];
  }

  std::size_t keypoints_ = 0, lists_ = 0;
  std::span<std::uint32_t> heads_, nexts_;
  // By slot, of one query:
  std::span<std::uint32_t> scores_, voters_;
  std::span<std::uint16_t> votes_;
};

}  // namespace plvo
