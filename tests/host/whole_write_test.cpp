// SPDX-License-Identifier: Apache-2.0
// Rows that a limit on the size of files cuts short are taken back, wherever they are written.
#include "plvo/host/files/whole_write.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <csignal>

#include "plvo/host/files/line_file.hpp"
#include "plvo/host/stream/bounded_writer.hpp"
#include "temporary_folder.hpp"

namespace plvo {
namespace {

using test::read_file;
using test::TemporaryFolder;

class WholeWrite : public ::testing::Test {
 protected:
  WholeWrite() {
    before_ = std::signal(SIGXFSZ, SIG_IGN);
    ::getrlimit(RLIMIT_FSIZE, &limit_);
    set_limit(100);
  }
  ~WholeWrite() override {
    ::setrlimit(RLIMIT_FSIZE, &limit_);
    std::signal(SIGXFSZ, before_);
  }
  void set_limit(rlim_t bytes) const {
    const rlimit less = {bytes, limit_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &less);
  }
  int open_file(int flags) const {
    return ::open((folder_ / "file").c_str(), O_WRONLY | O_CREAT | O_CLOEXEC | flags, 0644);
  }
  std::string written() const { return read_file(folder_ / "file"); }

  TemporaryFolder folder_;
  const std::string row_ = std::string(29, 'x') + '\n';  // three of them fit

 private:
  rlimit limit_{};
  void (*before_)(int) = nullptr;
};

TEST_F(WholeWrite, ALineFileHoldsWholeLines) {
  LineFile file;
  ASSERT_TRUE(file.open(folder_ / "file").ok());
  const std::string line(29, 'x');
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(file.write(line).ok());
  const Status full = file.write(line);
  EXPECT_EQ(full.code(), StatusCode::kIo);
  EXPECT_NE(std::string(full.message()).find("ulimit -f"), std::string::npos) << full.message();
  EXPECT_EQ(written(), row_ + row_ + row_);
  EXPECT_TRUE(file.write("short").ok()) << "the place is that of the last whole line";
  EXPECT_EQ(written(), row_ + row_ + row_ + "short\n");
}

TEST_F(WholeWrite, AFileThatAnotherProgramBeganHoldsWholeLines) {
  for (const int flags : {0, O_APPEND}) {
    test::write_file(folder_ / "file", "theirs\n");
    const int descriptor = open_file(flags);
    ::lseek(descriptor, 0, SEEK_END);
    for (int i = 0; i < 3; ++i) EXPECT_EQ(write_whole(descriptor, row_), 0);
    EXPECT_EQ(write_whole(descriptor, row_), EFBIG);
    EXPECT_EQ(write_whole(descriptor, row_), EFBIG);
    EXPECT_EQ(written(), "theirs\n" + row_ + row_ + row_);
    ::close(descriptor);
  }
}

TEST_F(WholeWrite, KeepsWhatAnotherProgramAppended) {
  set_limit(200);
  test::write_file(folder_ / "file", std::string(150, '-'));
  set_limit(100);
  const int descriptor = open_file(0);
  ::lseek(descriptor, 90, SEEK_SET);
  EXPECT_EQ(write_whole(descriptor, row_), EFBIG);
  EXPECT_EQ(written().size(), 150u);
  ::close(descriptor);
}

TEST_F(WholeWrite, APoseStreamIntoAFileHoldsWholeLines) {
  const int descriptor = open_file(O_TRUNC);
  BoundedWriter writer(descriptor, false, true, 1 << 16);
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(writer.write(row_));
  EXPECT_EQ(writer.sent_bytes(), 3 * row_.size());
  EXPECT_FALSE(writer.write(row_));
  EXPECT_TRUE(writer.gone());
  EXPECT_EQ(written(), row_ + row_ + row_);
}

TEST(WholeWriteToADevice, ReportsTheError) {
  const int full = ::open("/dev/full", O_WRONLY | O_CLOEXEC);
  EXPECT_EQ(write_whole(full, "text"), ENOSPC);
  ::close(full);
  EXPECT_STREQ(output_failed("write", "a.txt", ENOSPC).message(),
               "cannot write a.txt: No space left on device; free some space or choose another disk");
  EXPECT_STREQ(output_failed("write", "-", EPIPE).message(),
               "cannot write standard output: Broken pipe; the program that reads it has ended");
}

}  // namespace
}  // namespace plvo
