// SPDX-License-Identifier: Apache-2.0
// Who is connected to the live view, how long each has been at what, and who has to go. The places are few on
// purpose; connections that say nothing, crawl or never read may fill them and still keep no viewer out.
//
// The rule. When a newcomer's address has its share, or all places are taken, the newcomer gets the place of
// another: of the same address, or else of the address that holds most. First go those that have not finished
// a request, then those that are silent since their last reply, then those at their first reply, then those
// at a later one; among equals the one that has been at it for longest. And whoever takes longer for a
// request than kRequest_ns, or to take the reply than kReply_ns, is hung up on in any case.
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
  static constexpr std::int64_t kReply_ns = 10'000'000'000;   // with the wait for news

  // hang_up(descriptor): makes the server notice that the connection is over; the server closes it and says
  // so. Called with the table locked, so that the descriptor cannot have become another one meanwhile.
  explicit ConnectionTable(std::function<void(int)> hang_up) : hang_up_(std::move(hang_up)) {}

  // The server's calls, from any thread. Time is monotonic nanoseconds.
  void opened(int descriptor, const std::string& address, std::int64_t now_ns);
  void asked(int descriptor, std::int64_t now_ns);     // a whole request has come
  void answered(int descriptor, std::int64_t now_ns);  // the whole reply has gone
  void closed(int descriptor);
  void hang_up_overdue(std::int64_t now_ns);

  bool is_over(int descriptor) const;  // hung up on, and not yet closed

  std::size_t count() const;  // without those that were hung up on

 private:
  enum class Step : std::uint8_t { kNew, kSilent, kFirstReply, kReply };  // in this order they go
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
