// SPDX-License-Identifier: Apache-2.0
// Which reader of a pose stream yields its place to a newcomer. Over pairs of sockets, where what is written
// is there at once, so that nothing depends on time.
#include "plvo/host/stream/pose_readers.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>

namespace plvo {
namespace {

const std::string kLine = std::string(999, 'x').append(1, '\n');

class PoseReadersTest : public ::testing::Test {
 protected:
  ~PoseReadersTest() override {
    for (const int fd : ends_) ::close(fd);
  }
  // The reader's end of a new connection.
  int come(const std::string& address) {
    std::array<int, 2> pair{-1, -1};
    EXPECT_EQ(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0, pair.data()), 0);
    let_in_ = readers_.add_socket(pair[0], address);
    ends_.push_back(pair[1]);
    return pair[1];
  }
  static void read_all(int fd) {
    std::array<char, 4096> bytes{};
    while (::read(fd, bytes.data(), bytes.size()) > 0) {
    }
  }
  static bool is_connected(int fd) {
    pollfd one{fd, POLLRDHUP, 0};
    return ::poll(&one, 1, 0) == 0;
  }
  // Until these, who read, have taken what proves it.
  void prove(const std::vector<int>& who) {
    for (std::size_t bytes = 0; bytes <= PoseReaders::kProvenBytes; bytes += kLine.size()) {
      readers_.write(kLine);
      for (const int fd : who) read_all(fd);
    }
  }
  PoseReaders readers_;
  std::vector<int> ends_;
  bool let_in_ = false;
};

TEST_F(PoseReadersTest, TheOldestThatHasNotShownThatItReadsYields) {
  std::vector<int> all;
  for (std::size_t i = 0; i < PoseReaders::kMaxReaders; ++i)
    all.push_back(come("machine " + std::to_string(i)));
  const int newcomer = come("another");
  EXPECT_TRUE(let_in_);
  EXPECT_FALSE(is_connected(all[0]));
  EXPECT_TRUE(is_connected(all[1]));
  EXPECT_TRUE(is_connected(newcomer));
  EXPECT_EQ(readers_.count(), PoseReaders::kMaxReaders);
  EXPECT_EQ(readers_.turned_out(), 1u);
}

TEST_F(PoseReadersTest, TheOneThatKeepsLinesWaitingForLongestYieldsFirst) {
  std::vector<int> all;
  for (std::size_t i = 0; i < PoseReaders::kMaxReaders; ++i)
    all.push_back(come("machine " + std::to_string(i)));
  prove({all.begin(), all.end() - 2});  // the last two do not read
  read_all(all.back());                 // and the very last one begins to
  readers_.write(kLine);
  come("another");
  EXPECT_TRUE(let_in_);
  EXPECT_FALSE(is_connected(all[all.size() - 2]));
  EXPECT_TRUE(is_connected(all.back()));
}

TEST_F(PoseReadersTest, ReadersThatReadKeepTheirPlaces) {
  std::vector<int> all;
  for (std::size_t i = 0; i < PoseReaders::kMaxReaders; ++i)
    all.push_back(come("machine " + std::to_string(i)));
  prove(all);
  const int newcomer = come("another");
  EXPECT_FALSE(let_in_);
  EXPECT_FALSE(is_connected(newcomer));
  for (const int fd : all) EXPECT_TRUE(is_connected(fd));
}

TEST_F(PoseReadersTest, OneAddressHasItsShareAndPushesOutOnlyItsOwn) {
  const int other = come("other");  // the oldest of all, and it does not read
  std::vector<int> same;
  for (std::size_t i = 0; i < PoseReaders::kMaxPerAddress; ++i) same.push_back(come("greedy"));
  EXPECT_EQ(readers_.count(), PoseReaders::kMaxPerAddress + 1);
  for (int i = 0; i < 3; ++i) {
    come("greedy");
    EXPECT_TRUE(let_in_);
    EXPECT_FALSE(is_connected(same[static_cast<std::size_t>(i)]));
  }
  EXPECT_TRUE(is_connected(other));
  EXPECT_EQ(readers_.count(), PoseReaders::kMaxPerAddress + 1);
}

TEST_F(PoseReadersTest, UnixSocketsHaveNoShareAndWhatIsBorrowedStays) {
  std::array<int, 2> pipe{-1, -1};
  ASSERT_EQ(::pipe2(pipe.data(), O_CLOEXEC), 0);
  ends_ = {pipe[0], pipe[1]};
  readers_.add_borrowed(pipe[1]);
  for (std::size_t i = 0; i < 2 * PoseReaders::kMaxReaders; ++i) come("");
  EXPECT_EQ(readers_.count(), PoseReaders::kMaxReaders);
  readers_.write(kLine);
  char c = 0;
  EXPECT_EQ(::read(pipe[0], &c, 1), 1);
}

}  // namespace
}  // namespace plvo
