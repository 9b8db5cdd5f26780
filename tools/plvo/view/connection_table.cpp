// SPDX-License-Identifier: Apache-2.0
#include "plvo/view/connection_table.hpp"

#include <algorithm>
#include <tuple>
#include <utility>

namespace plvo {

void ConnectionTable::opened(int descriptor, const std::string& address, std::int64_t now_ns) {
  const std::lock_guard lock(mutex_);
  make_room(address);
  entries_[descriptor] = {address, Step::kNew, now_ns, false};
}

// Applies the rule at the top of the header. The caller holds mutex_.
void ConnectionTable::make_room(const std::string& address) {
  std::map<std::string, std::size_t> held;
  std::size_t all = 0;
  for (const auto& [descriptor, entry] : entries_) {
    if (entry.over) continue;
    ++held[entry.address];
    ++all;
  }
  std::string from = address;
  if (held[address] < kMaxPerAddress) {
    if (all < kMaxConnections) return;
    from = std::max_element(held.begin(), held.end(), [](const auto& a, const auto& b) {
             return a.second < b.second;
           })->first;
  }
  std::pair<const int, Entry>* worst = nullptr;
  for (auto& one : entries_) {
    if (one.second.over || one.second.address != from) continue;
    if (worst == nullptr || std::tie(one.second.step, one.second.since_ns) <
                                std::tie(worst->second.step, worst->second.since_ns)) {
      worst = &one;
    }
  }
  if (worst != nullptr) end(worst->first, worst->second);
}

void ConnectionTable::end(int descriptor, Entry& entry) {
  entry.over = true;
  hang_up_(descriptor);
}

void ConnectionTable::asked(int descriptor, std::int64_t now_ns) {
  const std::lock_guard lock(mutex_);
  const auto found = entries_.find(descriptor);
  if (found == entries_.end()) return;
  found->second.step = found->second.step == Step::kNew ? Step::kFirstReply : Step::kReply;
  found->second.since_ns = now_ns;
}

void ConnectionTable::answered(int descriptor, std::int64_t now_ns) {
  const std::lock_guard lock(mutex_);
  const auto found = entries_.find(descriptor);
  if (found == entries_.end()) return;
  found->second.step = Step::kSilent;
  found->second.since_ns = now_ns;
}

void ConnectionTable::closed(int descriptor) {
  const std::lock_guard lock(mutex_);
  entries_.erase(descriptor);
}

void ConnectionTable::hang_up_overdue(std::int64_t now_ns) {
  const std::lock_guard lock(mutex_);
  for (auto& [descriptor, entry] : entries_) {
    const std::int64_t limit = entry.step >= Step::kFirstReply ? kReply_ns : kRequest_ns;
    if (!entry.over && now_ns - entry.since_ns > limit) end(descriptor, entry);
  }
}

bool ConnectionTable::is_over(int descriptor) const {
  const std::lock_guard lock(mutex_);
  const auto found = entries_.find(descriptor);
  return found != entries_.end() && found->second.over;
}

std::size_t ConnectionTable::count() const {
  const std::lock_guard lock(mutex_);
  return static_cast<std::size_t>(
      std::count_if(entries_.begin(), entries_.end(), [](const auto& one) { return !one.second.over; }));
}

}  // namespace plvo
