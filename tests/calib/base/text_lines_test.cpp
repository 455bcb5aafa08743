// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/base/text_lines.h"

#include <gtest/gtest.h>

#include <clocale>
#include <cmath>
#include <optional>
#include <string>

namespace vernier {

using namespace internal;

namespace {

/// Sets a locale that writes 1,5 for 1.5, where the system has one, and the former one at the end.
class CommaLocale {
 public:
  CommaLocale() : former_(std::setlocale(LC_ALL, nullptr)) {
    for (const char* name : {"de_DE.UTF-8", "de_DE.utf8", "fr_FR.UTF-8", "de_DE", "fr_FR"}) {
      if (std::setlocale(LC_ALL, name)) return;
    }
  }
  ~CommaLocale() { std::setlocale(LC_ALL, former_.c_str()); }
  CommaLocale(const CommaLocale&) = delete;
  CommaLocale& operator=(const CommaLocale&) = delete;

 private:
  std::string former_;
};

TEST(ToReal, ReadsAPointAndNoCommaInEveryLocale) {
  const CommaLocale locale;
  EXPECT_EQ(to_real("1.5"), 1.5);
  EXPECT_EQ(to_real("-2.5e-3"), -2.5e-3);
  EXPECT_EQ(to_real("1,5"), std::nullopt);
  EXPECT_EQ(parse_real(" 1.5 ", "a.csv:1", "x"), 1.5);
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
