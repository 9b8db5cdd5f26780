// SPDX-License-Identifier: Apache-2.0
#include "plvo/replay/index/stamp_pairs.hpp"

#include <algorithm>
#include <functional>
#include <queue>
#include <tuple>

namespace plvo {
namespace {

constexpr std::size_t kNone = static_cast<std::size_t>(-1);

// A stamp of either list in the common order of both, linked with its neighbours that are still without a
// partner.
struct Node {
  std::int64_t stamp_ns = 0;
  std::size_t index = 0;
  bool is_second = false;
  bool paired = false;
  std::size_t previous = kNone, next = kNone;
};

std::vector<Node> merge(const std::vector<std::int64_t>& first, const std::vector<std::int64_t>& second) {
  std::vector<Node> nodes;
  nodes.reserve(first.size() + second.size());
  std::size_t i = 0;
  std::size_t j = 0;
  while (i < first.size() || j < second.size()) {
    const bool take_second = i == first.size() || (j < second.size() && second[j] < first[i]);
    nodes.push_back(take_second ? Node{second[j], j, true} : Node{first[i], i, false});
    ++(take_second ? j : i);
  }
  for (std::size_t n = 1; n < nodes.size(); ++n) {
    nodes[n].previous = n - 1;
    nodes[n - 1].next = n;
  }
  return nodes;
}

// Neighbours of different lists: their distance, the index in the first and in the second list, and the two
// nodes. Stamps may lie further apart than an int64 can say.
using Candidate = std::tuple<std::uint64_t, std::size_t, std::size_t, std::size_t, std::size_t>;

class Pairing {
 public:
  Pairing(std::vector<Node> nodes, std::uint64_t tolerance)
      : nodes_(std::move(nodes)), tolerance_(tolerance) {
    for (std::size_t n = 1; n < nodes_.size(); ++n) offer(n - 1, n);
  }

  std::vector<std::pair<std::size_t, std::size_t>> run() {
    std::vector<std::pair<std::size_t, std::size_t>> pairs;
    while (!candidates_.empty()) {
      const auto [distance, i, j, left, right] = candidates_.top();
      candidates_.pop();
      if (nodes_[left].paired || nodes_[right].paired) continue;
      pairs.emplace_back(i, j);
      nodes_[left].paired = nodes_[right].paired = true;
      const std::size_t before = nodes_[left].previous;
      const std::size_t after = nodes_[right].next;
      if (before != kNone) nodes_[before].next = after;
      if (after != kNone) nodes_[after].previous = before;
      if (before != kNone && after != kNone) offer(before, after);
    }
    std::sort(pairs.begin(), pairs.end());
    return pairs;
  }

 private:
  void offer(std::size_t left, std::size_t right) {
    const Node& a = nodes_[left];
    const Node& b = nodes_[right];
    if (a.is_second == b.is_second) return;
    const std::uint64_t distance =
        static_cast<std::uint64_t>(b.stamp_ns) - static_cast<std::uint64_t>(a.stamp_ns);
    if (distance > tolerance_) return;
    candidates_.emplace(distance, a.is_second ? b.index : a.index, a.is_second ? a.index : b.index, left,
                        right);
  }

  std::vector<Node> nodes_;
  std::uint64_t tolerance_;
  std::priority_queue<Candidate, std::vector<Candidate>, std::greater<>> candidates_;
};

}  // namespace

std::vector<std::pair<std::size_t, std::size_t>> associate(const std::vector<std::int64_t>& first,
                                                           const std::vector<std::int64_t>& second,
                                                           std::int64_t tolerance_ns) {
  if (tolerance_ns < 0) return {};
  return Pairing(merge(first, second), static_cast<std::uint64_t>(tolerance_ns)).run();
}

}  // namespace plvo
