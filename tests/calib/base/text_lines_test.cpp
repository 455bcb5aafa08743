// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/base/text_lines.h"

#include <gtest/gtest.h>

#include <clocale>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <optional>
#include <string>

#include "tests/support/error_message.h"
#include "tests/support/foreign_files.h"

namespace vernier {

using namespace vernier::internal;

namespace {

/// Sets a locale that writes 1,5 for 1.5, and the former one at the end: one of the system's or, as
/// minimal systems have none, one that localedef makes of the sources of Debian's package locales.
class CommaLocale {
 public:
  CommaLocale() {
    if (is_set("de_DE.UTF-8")) return;
    const std::string made = (folder_.path() / "de_DE.UTF-8").string();
    if (std::system(("localedef -i de_DE -f UTF-8 '" + made + "' >/dev/null 2>&1").c_str()) != 0) {
      return;
    }
    setenv("LOCPATH", folder_.path().c_str(), 1);
    is_set("de_DE.UTF-8");
    unsetenv("LOCPATH");
  }
  ~CommaLocale() { std::setlocale(LC_ALL, former_.c_str()); }
  CommaLocale(const CommaLocale&) = delete;
  CommaLocale& operator=(const CommaLocale&) = delete;

 private:
  static bool is_set(const char* name) { return std::setlocale(LC_ALL, name) != nullptr; }

  test::Folder folder_;
  std::string former_ = std::setlocale(LC_ALL, nullptr);
};

TEST(ToReal, ReadsAPointAndNoCommaInEveryLocale) {
  const CommaLocale locale;
  if (std::string(std::localeconv()->decimal_point) != ",") {
    GTEST_SKIP() << "no locale here writes a comma; install Debian's package locales";
  }
  ASSERT_EQ(std::strtod("1,5", nullptr), 1.5);
  EXPECT_EQ(to_real("1.5"), 1.5);
  EXPECT_EQ(to_real("-2.5e-3"), -2.5e-3);
  EXPECT_EQ(to_real("1,5"), std::nullopt);
  EXPECT_EQ(parse_real(" 1.5 ", "a.csv:1", "x"), 1.5);
}

TEST(ToReal, IsZeroForWhatIsTooSmallAndNothingForWhatIsTooLarge) {
  for (const char* text :
       {"1e-400", "+1e-400", "0.001e-330", "123e-400", "1e-99999999999999999999"}) {
    EXPECT_EQ(to_real(text), 0) << text;
  }
  EXPECT_TRUE(std::signbit(to_real("-1e-400").value()));
  EXPECT_EQ(to_real("0." + std::string(400, '0') + "1"), 0);
  for (const char* text : {"1e400", "-1e400", "0.001e400", "1e+400", "1e99999999999999999999"}) {
    EXPECT_EQ(to_real(text), std::nullopt) << text;
  }
  EXPECT_EQ(to_real("1" + std::string(400, '0')), std::nullopt);
  EXPECT_EQ(to_real("1e-400x"), std::nullopt);
  EXPECT_EQ(to_real("1e9223372036854775807"), std::nullopt);  // an overflow of its exponent once
  EXPECT_EQ(to_real("1e-9223372036854775807"), 0);
}

TEST(ParseReal, TakesOneSign) {
  EXPECT_EQ(parse_real("+1.5", "a.csv:1", "x"), 1.5);
  EXPECT_EQ(parse_real(" -1 ", "a.csv:1", "x"), -1);
  EXPECT_EQ(parse_real("1e-400", "a.csv:1", "x"), 0);
  for (const char* text : {"+-1", "++1", "-+1", "+", "+ 1"}) {
    EXPECT_EQ(
        test::error_message([&] { parse_real(text, "a.csv:1", "x"); }),
        "a.csv:1: x is \"" + std::string(text) + "\", not a number; correct or remove the line");
  }
}

TEST(ToReal, TakesNoMoreThanAThousandBytes) {
  EXPECT_EQ(to_real("1." + std::string(900, '0')), 1);
  EXPECT_EQ(to_real("1." + std::string(1'000'000, '0')), std::nullopt);
}

TEST(ParseWhole, RefusesWhatAnIntCannotHold) {
  EXPECT_EQ(parse_whole(" -2147483648", "a.csv:1", "x"), -2147483648);
  for (const std::string text : {"2147483648", "4294967297", "1e3", "0x10", "1.0", "+1", ""}) {
    EXPECT_NE(test::error_message([&] { parse_whole(text, "a.csv:1", "x"); }), "") << text;
  }
  const std::string said =
      test::error_message([&] { parse_whole(std::string(100'000, '9'), "a.csv:1", "x"); });
  EXPECT_LT(said.size(), 150U);
}

TEST(TextLines, RefusesALineThatIsTooLong) {
  const test::Folder folder;
  const auto file = folder.path() / "a.csv";
  std::ofstream(file) << "one\n" << std::string(100'000, 'x') << "\n";
  TextLines lines(file);
  std::string_view line;
  EXPECT_TRUE(lines.next(line));
  EXPECT_NE(
      test::error_message([&] { lines.next(line); }).find("a.csv:2: the line has 100000 bytes"),
      std::string::npos);
}

TEST(ToReal, TakesAllOfTheText) {
  EXPECT_EQ(to_real("+3"), 3);
  EXPECT_EQ(to_real("4e-320"), 4e-320);
  EXPECT_TRUE(std::isinf(to_real("inf").value()));
  EXPECT_TRUE(std::isnan(to_real("nan").value()));
  for (const char* text : {"", "+", "+-3", "1.5 ", " 1.5", "1.5x", "0x10", "one"}) {
    EXPECT_EQ(to_real(text), std::nullopt) << text;
  }
}

}  // namespace
}  // namespace vernier
