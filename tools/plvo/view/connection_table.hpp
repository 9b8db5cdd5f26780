// SPDX-License-Identifier: Apache-2.0
// Keeps the connections of the live view, with the state of each and its duration, and decides which one to
// close. The number of places is small on purpose; connections that are silent, slow or never read may fill
// the places and still keep no viewer out.
//
// The rule: a new connection replaces another one if its address has its share of places or all places are
// taken. The replaced connection has the same address in the first case, and the address with the most
// connections in the second. Connections go in this order: those without a complete request, those that are
// silent since their last reply, those at their first reply, those at a later reply; within a class the one
// that has been in this state longest. In addition, a connection is closed if a request takes longer than
// kRequest_ns or a reply longer than kReply_ns.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <string>

namespace plvo {

class ConnectionTable {
 public:
  static constexpr std::size_t kMaxConnections = 64;
  static constexpr std::size_t kMaxPerAddress = 32;
  static constexpr std::int64_t kRequest_ns = 5'000'000'000;  // from the connection or the last reply on
  static constexpr std::int64_t kReply_ns = 10'000'000'000;   // includes the wait for news

  // hang_up(descriptor): makes the server notice that the connection is over; the server closes it and calls
  // closed(). It is called with the table locked, so that the descriptor cannot have been reused.
  explicit ConnectionTable(std::function<void(int)> hang_up) : hang_up_(std::move(hang_up)) {}

  // Events reported by the server, from any thread. Times are monotonic nanoseconds.
  void opened(int descriptor, const std::string& address, std::int64_t now_ns);
  void asked(int descriptor, std::int64_t now_ns);     // a complete request has arrived
  void answered(int descriptor, std::int64_t now_ns);  // the complete reply was sent
  void closed(int descriptor);
  void hang_up_overdue(std::int64_t now_ns);

  bool is_over(int descriptor) const;  // ended by the table, not closed yet

  std::size_t count() const;  // without those that the table has ended

 private:
  enum class Step : std::uint8_t { kNew, kSilent, kFirstReply, kReply };  // the first is closed first
  struct Entry {
    std::string address;
    Step step = Step::kNew;
    std::int64_t since_ns = 0;
    bool over = false;
  };
  void make_room(const std::string& address);
  void end(int descriptor, Entry& entry);

  const std::function<void(int)> hang_up_;
  mutable std::mutex mutex_;
  std::map<int, Entry> entries_;  // by descriptor
};

}  // namespace plvo
