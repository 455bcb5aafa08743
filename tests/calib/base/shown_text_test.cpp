// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/base/shown_text.h"

#include <gtest/gtest.h>

#include "calib/base/utf8.h"

namespace vernier::internal {
namespace {

TEST(ShownText, QuotesAtMostSixtyCharacters) {
  EXPECT_EQ(in_quotes("left.png"), "\"left.png\"");
  EXPECT_EQ(in_quotes(std::string(60, 'a')), "\"" + std::string(60, 'a') + "\"");
  EXPECT_EQ(in_quotes(std::string(1'000'000, 'a')), "\"" + std::string(60, 'a') + "…\"");
  std::string accents;
  for (int i = 0; i < 70; ++i) accents += "é";
  EXPECT_EQ(shortened(accents), accents.substr(0, 120) + "…");
}

TEST(ShownText, EscapesWhatATerminalWouldObey) {
  EXPECT_EQ(shortened("a\x1b[31m\r\n\tb\x7f"), "a\\x1b[31m\\x0d\\x0a\\x09b\\x7f");
  EXPECT_EQ(shortened("\xC2\x9B\x31m"), "\\xc2\\x9b1m");  // C1
  EXPECT_EQ(shortened("a\xE2\x80\xAE\x62"),
            "a\\xe2\\x80\\xae"
            "b");                                  // right to left
  EXPECT_EQ(shortened("\xff\xC3"), "\\xff\\xc3");  // not UTF-8
  EXPECT_EQ(printable("café – 1…2 µm"), "café – 1…2 µm");
}

TEST(ShownText, CutsLongMessagesInTheMiddle) {
  const std::string begin = "a.json: ", end = "; correct it";
  EXPECT_EQ(printable(begin + "b" + end), begin + "b" + end);
  for (const std::string& filling :
       {std::string("b"), std::string("é"), std::string("\x1b"), std::string("\xff")}) {
    for (const int count : {100, 150, 300, 500, 600, 1000, 5000, 1'000'000}) {
      std::string middle;
      for (int i = 0; i < count; ++i) middle += filling;
      const std::string shown = printable(begin + middle + end);
      EXPECT_LT(shown.size(), 570U) << count;
      EXPECT_EQ(shown.substr(0, 8), begin);
      EXPECT_EQ(shown.substr(shown.size() - 12), end);
      EXPECT_EQ(first_bad_utf8(shown), std::string::npos);
      EXPECT_EQ(printable(shown), shown);
    }
  }
}

TEST(Utf8, FindsTheFirstBadByte) {
  EXPECT_EQ(first_bad_utf8("aé…😀"), std::string::npos);
  for (const char* bad : {"\x80", "\xC0\xAF", "\xC3", "\xE0\x80\x80", "\xED\xA0\x80",
                          "\xF0\x80\x80\x80", "\xF4\x90\x80\x80", "\xF5", "\xE2\x80", "\xFF"}) {
    EXPECT_EQ(first_bad_utf8(std::string("ab") + bad), 2U) << bad;
    EXPECT_EQ(first_bad_utf8(std::string("ab") + bad + "cd"), 2U) << bad;
  }
}

}  // namespace
}  // namespace vernier::internal
