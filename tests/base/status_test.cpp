// SPDX-License-Identifier: Apache-2.0
#include "plvo/base/status.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <limits>
#include <set>
#include <string>

namespace plvo {
namespace {

TEST(Status, DefaultIsOkWithoutText) {
  const Status status;
  EXPECT_TRUE(status.ok());
  EXPECT_EQ(status.code(), StatusCode::kOk);
  EXPECT_STREQ(status.message(), "");
}

TEST(Status, BuildsAMessageInOneExpression) {
  const Status status = Status(StatusCode::kOutOfMemory, "needs ").append(1234).append(" bytes");
  EXPECT_FALSE(status.ok());
  EXPECT_STREQ(status.message(), "needs 1234 bytes");
}

TEST(Status, AppendsEveryInteger) {
  using Limits = std::numeric_limits<std::ptrdiff_t>;
  const auto text = [](std::ptrdiff_t value) { return std::string(Status().append(value).message()); };
  EXPECT_EQ(text(0), "0");
  EXPECT_EQ(text(-7), "-7");
  EXPECT_EQ(text(Limits::max()), std::to_string(Limits::max()));
  EXPECT_EQ(text(Limits::min()), std::to_string(Limits::min()));
}

TEST(Status, TruncatesTextAtItsCapacity) {
  Status status(StatusCode::kIo, std::string(1000, 'x'));
  EXPECT_EQ(std::strlen(status.message()), Status::kCapacity - 1);
  status.append("more").append(42);
  EXPECT_EQ(std::strlen(status.message()), Status::kCapacity - 1);
}

TEST(Status, TruncatesBetweenUtf8Characters) {
  // "→" is three bytes of UTF-8. At every offset the message must end with a whole character.
  for (std::size_t offset = 0; offset < 4; ++offset) {
    std::string text(Status::kCapacity - 1 - offset, 'x');
    const std::size_t whole = text.size();
    text += "\xe2\x86\x92tail";
    const Status status(StatusCode::kIo, text);
    const std::size_t length = std::strlen(status.message());
    EXPECT_TRUE(offset < 3 ? length == whole : length == whole + 3) << offset << " " << length;
  }
}

TEST(Status, EveryCodeHasAUniqueName) {
  std::set<std::string> names;
  for (int code = 0; code <= static_cast<int>(StatusCode::kNotConverged); ++code)
    names.insert(to_string(static_cast<StatusCode>(code)));
  EXPECT_EQ(names.size(), static_cast<std::size_t>(StatusCode::kNotConverged) + 1);
  EXPECT_EQ(names.count("unknown"), 0U);
  EXPECT_STREQ(to_string(static_cast<StatusCode>(200)), "unknown");
}

TEST(Status, WorksAtCompileTime) {
  constexpr Status status = Status(StatusCode::kDamaged, "row ").append(-12);
  static_assert(!status.ok());
  EXPECT_STREQ(status.message(), "row -12");
}

}  // namespace
}  // namespace plvo
