// SPDX-License-Identifier: Apache-2.0
#include "plvo/host/printable.hpp"

#include <gtest/gtest.h>

namespace plvo {
namespace {

using namespace std::string_literals;

TEST(Printable, WhatCanBeShownStays) {
  for (const std::string& text :
       {""s, "a plain name.png"s, "C:\\sequence"s, "Büro – 3 µm"s, "\u65e5\u672c"s, "\U0001F600"s, "\u00a0"s})
    EXPECT_EQ(printable(text), text);
}

TEST(Printable, ControlCharactersAreEscaped) {
  EXPECT_EQ(printable("\x1b[31mred"), "\\x1b[31mred");
  EXPECT_EQ(printable("a\r\b\x7f"), "a\\x0d\\x08\\x7f");
  EXPECT_EQ(printable("a\0b"s), "a\\x00b");
  EXPECT_EQ(printable("two\nlines\tand"), "two\\nlines\\tand");
  EXPECT_EQ(printable("\u009b32m\u0085"), "\\u009b32m\\u0085") << "C1, as UTF-8 has them";
}

TEST(Printable, WhatTurnsOrSeparatesTextIsEscaped) {
  EXPECT_EQ(printable("a\u202egnp.exe\u2066\u200f\u061c"), "a\\u202egnp.exe\\u2066\\u200f\\u061c");
  EXPECT_EQ(printable("a\u2028b\u2029"), "a\\u2028b\\u2029");
}

TEST(Printable, BytesThatAreNotUtf8AreEscaped) {
  EXPECT_EQ(printable("\x9b\xff"), "\\x9b\\xff");
  EXPECT_EQ(printable("\xc0\x9b"), "\\xc0\\x9b") << "not the shortest form";
  EXPECT_EQ(printable("\xe0\x82\x9b"), "\\xe0\\x82\\x9b") << "nor this one";
  EXPECT_EQ(printable("\xf0\x80\x82\x9b"), "\\xf0\\x80\\x82\\x9b");
  EXPECT_EQ(printable("\xed\xa0\x80"), "\\xed\\xa0\\x80") << "a surrogate";
  EXPECT_EQ(printable("\xf4\x90\x80\x80"), "\\xf4\\x90\\x80\\x80") << "beyond U+10FFFF";
  EXPECT_EQ(printable("cut\xe2\x82"), "cut\\xe2\\x82");
  EXPECT_EQ(printable("\xe2(\xa1"), "\\xe2(\\xa1");
}

TEST(Printable, LinesKeepTheirNewlinesAlone) {
  EXPECT_EQ(printable_lines("one\ntwo\x1b\t\n"), "one\ntwo\\x1b\\t\n");
}

TEST(Printable, WhatWasEscapedIsShown) {
  const std::string once = printable("\x1b\n\xff\u009b");
  EXPECT_EQ(printable(once), once);
}

}  // namespace
}  // namespace plvo
