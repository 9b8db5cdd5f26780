// SPDX-License-Identifier: Apache-2.0
// Two lists of stamps and a tolerance from any bytes: the fast pairing equals an exhaustive one.
#include <algorithm>
#include <cstdint>
#include <limits>
#include <vector>

#include "plvo/replay/index/stamp_pairs.hpp"
#include "scratch_file.hpp"

namespace {

using Pairs = std::vector<std::pair<std::size_t, std::size_t>>;

std::uint64_t distance(std::int64_t a, std::int64_t b) {
  return static_cast<std::uint64_t>(std::max(a, b)) - static_cast<std::uint64_t>(std::min(a, b));
}

Pairs slow(const std::vector<std::int64_t>& a, const std::vector<std::int64_t>& b, std::uint64_t tolerance) {
  std::vector<char> used_a(a.size()), used_b(b.size());
  Pairs pairs;
  for (;;) {
    bool found = false;
    std::uint64_t best = 0;
    std::pair<std::size_t, std::size_t> choice;
    for (std::size_t i = 0; i < a.size(); ++i) {
      for (std::size_t j = 0; j < b.size(); ++j) {
        const std::uint64_t d = distance(a[i], b[j]);
        if (used_a[i] != 0 || used_b[j] != 0 || d > tolerance || (found && d >= best)) continue;
        found = true;
        best = d;
        choice = {i, j};
      }
    }
    if (!found) break;
    used_a[choice.first] = used_b[choice.second] = 1;
    pairs.push_back(choice);
  }
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

}  // namespace

// The first byte is the tolerance, the second the unit. Each further byte gives the list and the step of the
// next stamp.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 2) return 0;
  constexpr std::size_t kMost = 40;  // per list; the exhaustive pairing takes cubic time
  const std::int64_t unit = data[1] % 3 == 0 ? 1 : data[1] % 3 == 1 ? 1'000'000 : std::int64_t{1} << 57;
  const std::int64_t tolerance =
      data[0] == 255 ? std::numeric_limits<std::int64_t>::max() : data[0] % 63 * unit;
  std::vector<std::int64_t> lists[2];
  std::int64_t last[2] = {std::numeric_limits<std::int64_t>::min(), std::numeric_limits<std::int64_t>::min()};
  for (std::size_t n = 2; n < size; ++n) {
    const int which = data[n] & 1;
    const std::int64_t step = 1 + (data[n] >> 1) % 60 * unit;
    if (lists[which].size() == kMost || last[which] > std::numeric_limits<std::int64_t>::max() - step)
      continue;
    lists[which].push_back(last[which] += step);
  }
  plvo::fuzz::require(plvo::associate(lists[0], lists[1], tolerance) ==
                      slow(lists[0], lists[1], static_cast<std::uint64_t>(tolerance)));
  return 0;
}
