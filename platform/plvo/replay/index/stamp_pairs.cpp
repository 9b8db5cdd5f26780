// SPDX-License-Identifier: Apache-2.0
#include "plvo/replay/index/stamp_pairs.hpp"

#include <algorithm>
#include <utility>

namespace plvo {
namespace {

constexpr std::uint32_t kNone = UINT32_MAX;

// A stamp of either list in the common order of both. It is linked with the adjacent stamps that are still
// without a partner.
struct Node {
  std::int64_t stamp_ns = 0;
  std::uint32_t index = 0;
  std::uint32_t previous = kNone, next = kNone;
  bool is_second = false;
  bool paired = false;
};

std::vector<Node> merge(const std::vector<std::int64_t>& first, const std::vector<std::int64_t>& second) {
  std::vector<Node> nodes;
  nodes.reserve(first.size() + second.size());
  std::size_t i = 0;
  std::size_t j = 0;
  while (i < first.size() || j < second.size()) {
    const bool take_second = i == first.size() || (j < second.size() && second[j] < first[i]);
    Node node;
    node.stamp_ns = take_second ? second[j] : first[i];
    node.index = static_cast<std::uint32_t>(take_second ? j : i);
    node.is_second = take_second;
    nodes.push_back(node);
    ++(take_second ? j : i);
  }
  for (std::uint32_t n = 1; n < nodes.size(); ++n) {
    nodes[n].previous = n - 1;
    nodes[n - 1].next = n;
  }
  return nodes;
}

// Adjacent stamps of different lists. Their difference may exceed an int64.
struct Candidate {
  std::uint64_t distance = 0;
  std::uint32_t left = 0, right = 0;  // nodes
};

class Pairing {
  auto later() const {
    return [this](const Candidate& a, const Candidate& b) {
      if (a.distance != b.distance) return a.distance > b.distance;
      return indices(a.left, a.right) > indices(b.left, b.right);
    };
  }

 public:
  Pairing(std::vector<Node> nodes, std::uint64_t tolerance)
      : nodes_(std::move(nodes)), tolerance_(tolerance) {
    candidates_.reserve(nodes_.size());
    for (std::uint32_t n = 1; n < nodes_.size(); ++n) offer(n - 1, n);
  }

  std::vector<std::pair<std::size_t, std::size_t>> run() {
    std::vector<std::pair<std::size_t, std::size_t>> pairs;
    pairs.reserve(nodes_.size() / 2);
    while (!candidates_.empty()) {
      std::pop_heap(candidates_.begin(), candidates_.end(), later());
      const auto [distance, left, right] = candidates_.back();
      candidates_.pop_back();
      if (nodes_[left].paired || nodes_[right].paired) continue;
      pairs.push_back(indices(left, right));
      nodes_[left].paired = nodes_[right].paired = true;
      const std::uint32_t before = nodes_[left].previous;
      const std::uint32_t after = nodes_[right].next;
      if (before != kNone) nodes_[before].next = after;
      if (after != kNone) nodes_[after].previous = before;
      if (before != kNone && after != kNone) offer(before, after);
    }
    std::sort(pairs.begin(), pairs.end());
    return pairs;
  }

 private:
  // Indices in the first and in the second list.
  std::pair<std::size_t, std::size_t> indices(std::uint32_t left, std::uint32_t right) const {
    const Node &a = nodes_[left], &b = nodes_[right];
    return a.is_second ? std::pair<std::size_t, std::size_t>(b.index, a.index)
                       : std::pair<std::size_t, std::size_t>(a.index, b.index);
  }

  void offer(std::uint32_t left, std::uint32_t right) {
    const Node& a = nodes_[left];
    const Node& b = nodes_[right];
    if (a.is_second == b.is_second) return;
    const std::uint64_t distance =
        static_cast<std::uint64_t>(b.stamp_ns) - static_cast<std::uint64_t>(a.stamp_ns);
    if (distance > tolerance_) return;
    candidates_.push_back({distance, left, right});
    std::push_heap(candidates_.begin(), candidates_.end(), later());
  }

  std::vector<Node> nodes_;
  std::uint64_t tolerance_;
  std::vector<Candidate> candidates_;  // a heap, the nearest on top
};

}  // namespace

std::vector<std::pair<std::size_t, std::size_t>> associate(const std::vector<std::int64_t>& first,
                                                           const std::vector<std::int64_t>& second,
                                                           std::int64_t tolerance_ns) {
  if (tolerance_ns < 0) return {};
  return Pairing(merge(first, second), static_cast<std::uint64_t>(tolerance_ns)).run();
}

}  // namespace plvo
