// SPDX-License-Identifier: Apache-2.0
#include "memory_table.hpp"

#include <algorithm>

#include "procedural_sequence.hpp"

namespace plvo {
namespace {

std::string with_commas(std::size_t value) {
  const std::string digits = std::to_string(value);
  std::string text;
  for (std::size_t i = 0; i < digits.size(); ++i) {
    if (i > 0 && (digits.size() - i) % 3 == 0) text += ',';
    text += digits[i];
  }
  return text;
}

using Bytes = std::array<std::size_t, 3>;

std::string row(const std::string& who, const Bytes& bytes) {
  std::string text = "| " + who + " |";
  for (const std::size_t n : bytes) text += " " + with_commas(n) + " |";
  return text + "\n";
}

std::string capacities(const char* name, const Limits& limits) {
  return std::string("- ") + name + ": " + std::to_string(limits.width) + "x" +
         std::to_string(limits.height) + " px, " + std::to_string(limits.keypoints) + " keypoints, " +
         std::to_string(limits.segments) + " segments, matched with " +
         (limits.references == 1 ? "one frame, " : "two frames, ") + std::to_string(limits.kept_keyframes) +
         " kept after a loss\n";
}

}  // namespace

MemoryUse measure_memory(const Limits& limits, const Config& config, int frames) {
  MemoryUse use;
  use.limits = limits;
  use.required = required_bytes(limits);
  std::vector<std::byte> memory(use.required);
  ProceduralSequence sequence(limits.width, limits.height);
  Odometry odometry;
  if (!odometry.init(memory, sequence.camera(), config, limits).ok()) return use;
  use.used = odometry.memory_used();
  for (int i = 0; i < frames; ++i) (void)odometry.track(sequence.render(i));
  use.peak = odometry.memory_peak();
  for (const Arena::Record& record : odometry.memory_records())
    use.rows.push_back({record.who, record.bytes});
  return use;
}

std::string memory_page(const std::array<MemoryUse, 3>& vga_qvga_tiny) {
  const auto all = [&](const auto& what) {
    Bytes bytes{};
    for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = what(vga_qvga_tiny[i]);
    return bytes;
  };
  std::string page =
      "<!-- SPDX-License-Identifier: Apache-2.0 -->\n# Memory\n\n"
      "The caller owns one block; `init` allocates it once, and nothing is taken from anywhere else, then or "
      "later. This first\n"
      "part of the page is written by a test (`tests/odometry/memory_test.cpp`), which fails when the "
      "figures "
      "are no longer true.\n"
      "To write it anew: `PLVO_UPDATE_DOCS=1 ctest --preset release -R '^memory_test$'`.\n\n"
      "Bytes on a 64-bit machine, by what `init` takes them for:\n\n"
      "| for | VGA | QVGA | tiny |\n|---|---:|---:|---:|\n";
  for (const MemoryUse::Row& r : vga_qvga_tiny[0].rows)
    page += row(r.who, all([&](const MemoryUse& use) {
                  const auto same = std::find_if(use.rows.begin(), use.rows.end(),
                                                 [&](const auto& q) { return q.who == r.who; });
                  return same == use.rows.end() ? 0 : same->bytes;
                }));
  page += row("scratch of one stage, given back after it",
              all([](const MemoryUse& use) { return use.required - use.used; }));
  page += row("**`required_bytes(limits)`**", all([](const MemoryUse& use) { return use.required; }));
  page += row("at most, in the test", {kVgaCeiling, kQvgaCeiling, kTinyCeiling});
  page += row("`sizeof(plvo::Odometry)`, wherever the caller puts it",
              all([](const MemoryUse&) { return sizeof(Odometry); }));
  page += "\nThe capacities (`plvo::Limits`) that these are for:\n\n";
  page += capacities("VGA", vga_qvga_tiny[0].limits) + capacities("QVGA", vga_qvga_tiny[1].limits) +
          capacities("tiny", vga_qvga_tiny[2].limits);
  page +=
      "\nMore keypoints or segments cost what the rows say in proportion. A block that is too small is "
      "refused by `init`\n"
      "with the number of bytes that it needs.\n";
  return page;
}

}  // namespace plvo
