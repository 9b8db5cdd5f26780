// SPDX-License-Identifier: Apache-2.0
#include "plvo/host/files/input_file.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <string_view>

#include "says.hpp"
#include "temporary_folder.hpp"

namespace plvo {
namespace {

using test::says;
using test::TemporaryFolder;
using test::write_file;

TEST(InputFile, ReadsWholeFiles) {
  const TemporaryFolder folder;
  std::vector<unsigned char> bytes;
  for (const std::size_t size : {std::size_t{0}, std::size_t{1}, std::size_t{65536}, std::size_t{200001}}) {
    std::string content(size, 'x');
    if (size > 0) content.back() = '\0';
    write_file(folder / "f", content);
    ASSERT_TRUE(read_input_file(folder / "f", size, bytes).ok()) << "the limit itself is allowed";
    EXPECT_EQ(std::string(bytes.begin(), bytes.end()), content);
  }
  // Files of the kernel say that they have no bytes.
  ASSERT_TRUE(read_input_file("/proc/self/status", 1u << 20, bytes).ok());
  EXPECT_GT(bytes.size(), 100u);
  EXPECT_TRUE(says(read_input_file("/proc/self/status", 10, bytes), "is longer than the 10 bytes"));
  EXPECT_TRUE(bytes.empty());
}

TEST(InputFile, KeepsItsBuffer) {
  const TemporaryFolder folder;
  std::vector<unsigned char> bytes(1000);
  const unsigned char* before = bytes.data();
  write_file(folder / "f", std::string(1000, 'a'));
  ASSERT_TRUE(read_input_file(folder / "f", 1000, bytes).ok());
  EXPECT_EQ(bytes.data(), before);
}

TEST(InputFile, RefusesFoldersAndDevices) {
  const TemporaryFolder folder;
  std::vector<unsigned char> bytes;
  EXPECT_EQ(read_input_file(folder / "none", 10, bytes).code(), StatusCode::kNotFound);
  EXPECT_TRUE(says(read_input_file(folder.path(), 10, bytes), "it is a folder; name a file"));
  EXPECT_TRUE(says(read_input_file("/dev/zero", 10, bytes), "it is a device; save what comes from it"));
  ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
  EXPECT_TRUE(says(read_input_file(folder / "pipe", 10, bytes), "it is a pipe"))
      << "and nobody waited for a writer";
}

TEST(InputFile, RefusesTooLargeFilesBeforeReadingThem) {
  const TemporaryFolder folder;
  write_file(folder / "holes", "");
  std::filesystem::resize_file(folder / "holes", std::uintmax_t{1} << 40);
  std::vector<unsigned char> bytes;
  EXPECT_TRUE(says(read_input_file(folder / "holes", 1u << 20, bytes),
                   "has 1099511627776 bytes, more than the 1048576"));
  EXPECT_EQ(bytes.capacity(), 0u);
}

TEST(InputFile, TakesTheByteOrderMarkOffText) {
  const TemporaryFolder folder;
  std::string text;
  write_file(folder / "f", "\xEF\xBB\xBFhello\n");
  ASSERT_TRUE(read_text_file(folder / "f", 100, text).ok());
  EXPECT_EQ(text, "hello\n");
  write_file(folder / "f", std::string_view("\xFE\xFF\0h", 4));
  EXPECT_EQ(read_text_file(folder / "f", 100, text).code(), StatusCode::kDamaged);
}

}  // namespace
}  // namespace plvo
