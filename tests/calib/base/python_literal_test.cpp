// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/base/python_literal.h"

#include <gtest/gtest.h>

#include <cstddef>

#include "tests/support/error_message.h"

namespace vernier::internal {
namespace {

std::string literal_complaint(const std::string& text) {
  return test::error_message([&] { parse_python_literal(text, "a.cameramodel"); });
}

TEST(PythonLiteral, ReadsWhatMrcalAndNumPyWrite) {
  const PythonLiteral value = parse_python_literal(
      "# a comment\n{ 'lensmodel': 'LENSMODEL_OPENCV4', # another\n 'x': [1, -2.5e-3, +3,],\n"
      "'shape': (480, 640), 'order': False, 'data': b'ab' 'cd' }\n",
      "a");
  EXPECT_EQ(value.find("x")->items.at(1).number, -2.5e-3);
  EXPECT_EQ(value.find("shape")->items.size(), 2U);
  EXPECT_EQ(value.find("order")->text, "False");
  EXPECT_EQ(value.find("data")->text, "abcd");
  EXPECT_EQ(value.find("x")->line, 3);
}

TEST(PythonLiteral, RefusesDepthLengthAndRange) {
  for (const std::size_t depth : {40U, 100'000U}) {
    EXPECT_NE(
        literal_complaint(std::string(depth, '[')).find(":1: is nested more than 32 levels deep"),
        std::string::npos);
  }
  EXPECT_NE(
      literal_complaint("[1,\n1e309]").find(":2: \"1e309\" is not a number that a double can hold"),
      std::string::npos);
  EXPECT_EQ(literal_complaint("[1e-400]"), "");
  EXPECT_NE(literal_complaint("[" + std::string(2'000, '1') + "]").find("more than 1000 bytes"),
            std::string::npos);
  std::string many = "[";
  for (int i = 0; i < 100'001; ++i) many += "1,";
  EXPECT_NE(literal_complaint(many + "]").find("more than 100000 values"), std::string::npos);
}

TEST(PythonLiteral, RefusesAKeyGivenTwice) {
  EXPECT_NE(literal_complaint("{'a': 1,\n'a': 2}").find(":2: has the key 'a' twice"),
            std::string::npos);
}

TEST(PythonLiteral, RefusesWhatIsCutOrNotUtf8) {
  const std::string whole = "{'a': [1, 2], 'b': 'c'}";
  for (std::size_t cut = 0; cut < whole.size(); ++cut)
    EXPECT_NE(literal_complaint(whole.substr(0, cut)), "");
  EXPECT_NE(literal_complaint("{'a': '\xff'}").find("is not UTF-8"), std::string::npos);
  EXPECT_NE(literal_complaint("[\x1b]").find("\"\\x1b\""), std::string::npos);
}

}  // namespace
}  // namespace vernier::internal
