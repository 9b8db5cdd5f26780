// SPDX-License-Identifier: Apache-2.0
#include "plvo/host/stream/pose_readers.hpp"

#include <unistd.h>

#include <algorithm>
#include <utility>

namespace plvo {

bool PoseReaders::add_socket(int descriptor, const std::string& address) {
  if (!make_room(address)) {
    ++turned_out_;
    ::close(descriptor);
    return false;
  }
  readers_.push_back({BoundedWriter(descriptor, true, true, kBufferBytes), address});
  return true;
}

void PoseReaders::add_borrowed(int descriptor) {
  readers_.push_back({BoundedWriter(descriptor, false, false, kBufferBytes), {}, true});
}

// The rule at the top of the header.
bool PoseReaders::make_room(const std::string& address) {
  const auto same_address =
      std::count_if(readers_.begin(), readers_.end(), [&](const Reader& r) { return r.address == address; });
  const bool share_is_used = !address.empty() && static_cast<std::size_t>(same_address) >= kMaxPerAddress;
  if (!share_is_used && readers_.size() < kMaxReaders) return true;
  std::size_t worst = readers_.size();
  for (std::size_t i = 0; i < readers_.size(); ++i) {
    const Reader& reader = readers_[i];
    if (reader.borrowed || (share_is_used && reader.address != address)) continue;
    if (reader.waiting_lines == 0 && reader.writer.sent_bytes() >= kProvenBytes) continue;
    if (worst == readers_.size() || reader.waiting_lines > readers_[worst].waiting_lines) worst = i;
  }
  if (worst == readers_.size()) return false;
  forget(worst);
  ++turned_out_;
  return true;
}

void PoseReaders::forget(std::size_t index) {
  dropped_by_gone_ += readers_[index].writer.dropped();
  readers_.erase(readers_.begin() + static_cast<std::ptrdiff_t>(index));
}

void PoseReaders::write(std::string_view line) {
  for (std::size_t i = 0; i < readers_.size();) {
    Reader& reader = readers_[i];
    const bool there = reader.writer.write(line);
    reader.waiting_lines = reader.writer.all_sent() ? 0 : reader.waiting_lines + 1;
    if (there) {
      ++i;
    } else {
      forget(i);
    }
  }
}

void PoseReaders::close() {
  for (Reader& reader : readers_) reader.writer.drain(100);
  while (!readers_.empty()) forget(readers_.size() - 1);
}

std::uint64_t PoseReaders::dropped_lines() const {
  std::uint64_t sum = dropped_by_gone_;
  for (const Reader& reader : readers_) sum += reader.writer.dropped();
  return sum;
}

}  // namespace plvo
