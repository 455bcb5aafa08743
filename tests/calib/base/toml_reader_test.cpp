// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/base/toml_reader.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>

#include "calib/base/toml_grammar.h"
#include "calib/base/toml_writer.h"
#include "tests/support/error_message.h"
#include "tests/support/texts.h"

namespace vernier::internal {
namespace {

std::string toml_complaint(const std::string& text) {
  return test::error_message([&] { parse_toml(text, "a.toml"); });
}

TEST(TomlReader, ReadsAllOfTheLanguageButDates) {
  const toml::table root = parse_toml(
      "\xEF\xBB\xBF# a comment \xC3\xA9\r\n"
      "\"a b\" = 'c\\d' # another\n"
      "'é'.x-1_2 = \"\\u00e9\\t\\\\\"\n"
      "n = [ 1, +2, -3, 1_000, 0x1F, 0o17, 0b101, 1.5, -2e-3, 1_0.5E+2, inf, -nan, 0, -0.0 ]\n"
      "t = { a = true, b.c = false, d = {} }\n"
      "l = [\n  [ ], # one\n  [ 'x', \"y\", ],\n]\n"
      "m = \"\"\"\\\n   first \"quoted\" \\\"\"\" second\"\"\"\"\n"
      "r = '''\nraw \\ ''text'''''\n"
      "[ table . \"sub table\" ]\nk = 1\n[[list]]\n[[list]]\nk = 2\n[list.deeper]\n",
      "a.toml");
  EXPECT_EQ(root["a b"].value<std::string>(), "c\\d");
  EXPECT_EQ(root["é"]["x-1_2"].value<std::string>(), "é\t\\");
  EXPECT_EQ(root["n"].as_array()->size(), 14U);
  EXPECT_EQ(root["n"][4].value<int>(), 31);
  EXPECT_EQ(root["t"]["b"]["c"].value<bool>(), false);
  EXPECT_EQ(root["m"].value<std::string>(), "first \"quoted\" \"\"\" second\"");
  EXPECT_EQ(root["r"].value<std::string>(), "raw \\ ''text''");
  EXPECT_EQ(root["table"]["sub table"]["k"].value<int>(), 1);
  EXPECT_EQ(root["list"].as_array()->size(), 2U);
}

// toml++ 3.3 has no defined behaviour for these.
TEST(TomlReader, RefusesJoinedLinesThatBeginBeyondAscii) {
  const auto joined = [](const std::string& next) {
    return toml_complaint("m = \"\"\"a \\ \n \n\t" + next + "\"\"\"");
  };
  EXPECT_EQ(joined("e"), "");
  for (const char* next : {"é", "\u3042", "\xC2\xA0"}) {
    EXPECT_EQ(joined(next),
              "a.toml:3: holds a backslash at the end of a line before a character beyond ASCII; "
              "leave the backslash out, or join the lines");
  }
}

TEST(TomlReader, ShowsValues) {
  const toml::table root = parse_toml("a = [ 1, [-119.5, inf], true, 'x', {} ]", "a.toml");
  EXPECT_EQ(shown_value(*root.get("a")), "[1, [-119.5, inf], true, x, a table]");
}

// Property: what is written reads as the same, numbers to the bit.
TEST(TomlWriter, WritesWhatItReads) {
  const toml::table root = parse_toml(
      "top = 'a \\ \"quoted\" text'\nlines = \"one\\ntwo\\t\\u0001\"\n"
      "small = [1e-123, 0.05, -0.1, 5e-324, [nan], [], [{}]]\n"
      "\"a.b\".\"c \\n d\" = [-0.0, 1e308, inf, -inf, 0.1, 3.0, 3, -9223372036854775808]\n"
      "mixed = [{x = 1, y = {z = 'é'}}, true]\n[empty]\n[deep.er.est]\nk = false\n"
      "[[many.tables]]\na = 1\n[many.tables.inner]\nb = 2.5\n[[many.tables]]\n",
      "a.toml");
  const std::string text = toml_text(root);
  const toml::table again = parse_toml(text, "b.toml");
  EXPECT_EQ(toml_text(again), text);
  EXPECT_TRUE(std::isnan(again["small"][4][0].value<double>().value_or(0)));
  EXPECT_EQ(again["small"][3].value<double>(), 5e-324);
  EXPECT_EQ(again["a.b"]["c \n d"][4].value<double>(), 0.1);
  EXPECT_EQ(again["lines"].value<std::string>(), "one\ntwo\t\x01");
  EXPECT_EQ(again["many"]["tables"][0]["inner"]["b"].value<double>(), 2.5);
  EXPECT_EQ(again["many"]["tables"].as_array()->size(), 2u);
  EXPECT_TRUE(again["empty"].is_table());
  EXPECT_TRUE(toml_text({}).empty());
}

TEST(TomlReader, RefusesDepth) {
  EXPECT_EQ(toml_complaint("a = " + test::repeated("[", 31) + test::repeated("]", 31)), "");
  const std::string fault = "a.toml:1: is nested more than 32 levels deep; flatten it";
  for (const std::size_t depth : {33U, 50'000U, 1'000'000U}) {
    EXPECT_EQ(toml_complaint("a" + test::repeated(".a", depth) + " = 1"), fault);
    EXPECT_EQ(toml_complaint("[a" + test::repeated(".a", depth) + "]"), fault);
    EXPECT_EQ(toml_complaint("[[a" + test::repeated(".a", depth) + "]]"), fault);
    EXPECT_EQ(toml_complaint("a = " + test::repeated("[", depth)), fault);
    EXPECT_EQ(toml_complaint("a = " + test::repeated("{a=", depth)), fault);
  }
  EXPECT_NE(
      toml_complaint("[a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a]\nb.b.b.b.b.b.b.b.b.b.b.b.b.b = [[[1]]]"),
      "");
}

TEST(TomlReader, RefusesAKeyGivenTwice) {
  for (const char* text : {"a = 1\na = 2", "a.b = 1\na.b = 2", "[a]\n[a]", "a = { b = 1, b = 2 }",
                           "[a]\nb = 1\n[a.b]", "a = 1\n[[a]]", "\"a\" = 1\n'a' = 2"}) {
    EXPECT_NE(toml_complaint(text).find("a.toml:"), std::string::npos) << text;
    EXPECT_NE(toml_complaint(text).find("defines what is defined before"), std::string::npos)
        << text;
  }
}

TEST(TomlReader, ShowsALineThatRepeatsAKeyAsItIs) {
  const std::string rest = " defines what is defined before; define every key and table once";
  EXPECT_EQ(toml_complaint("\"k\\u001b\" = 1\r\n  \"k\\u001b\" = 2 \r\n"),
            "a.toml:2: \"\"k\\u001b\" = 2\"" + rest);
  EXPECT_EQ(toml_complaint("a = { x = 1 }\na.y = 2"), "a.toml:2: \"a.y = 2\"" + rest);
  EXPECT_EQ(toml_complaint("\xEF\xBB\xBFt = 1\n\n\t[[t]]"), "a.toml:3: \"[[t]]\"" + rest);
  EXPECT_EQ(toml_complaint("\"é ü\" = 1\n\"é ü\" = 1"), "a.toml:2: \"\"é ü\" = 1\"" + rest);
}

TEST(TomlReader, RefusesNumbersOutOfRange) {
  EXPECT_EQ(toml_complaint("\na = 1e309"),
            "a.toml:2: \"1e309\" is not a number that a double can hold; correct it");
  EXPECT_EQ(toml_complaint("a = 9223372036854775807"), "");
  EXPECT_NE(toml_complaint("a = 9223372036854775808").find("too large a whole number"),
            std::string::npos);
  EXPECT_NE(toml_complaint("a = 0x8000000000000000").find("too large a whole number"),
            std::string::npos);
  EXPECT_NE(toml_complaint("a = 1." + std::string(1'000, '1')).find("more than 100 bytes"),
            std::string::npos);
  for (const char* word : {"01",  "1_",  "_1",  "1__0",  "1.",    ".5",         "1e",       "1e+",
                           "0x",  "0xG", "0b2", "+0x1",  "0x1p3", "1979-05-27", "07:32:00", "TRUE",
                           "one", "+",   "--1", "1.5.2", "INF",   "1 2"}) {
    EXPECT_NE(toml_complaint(std::string("a = ") + word), "") << word;
  }
}

TEST(TomlReader, RefusesSyntaxThatItsLibraryWouldNotSurvive) {
  for (const char* text : {"[/",
                           "[",
                           "[[",
                           "[]",
                           "[[]]",
                           "[a",
                           "[[a]",
                           "[a]]",
                           "[a] b = 1",
                           "[a.]",
                           "[.a]",
                           "= 1",
                           "a",
                           "a =",
                           "a = ]",
                           "a = }",
                           "a = ,",
                           "a = 1, ",
                           "\xC3\xA9 = 1",
                           "\xF0\xAF\xA0\xB0 = 1",
                           "a\xE2\x80\xA8 = 1",
                           "[\xE2\x80\xA8]",
                           "a = \"b",
                           "a = 'b",
                           "a = \"\"\"b",
                           "a = \"b\nc\"",
                           "a = \"\\x\"",
                           "a = \"\\ud800\"",
                           "a = \"\\u12\"",
                           "a = \"\x01\"",
                           "# \x01",
                           "a = 1 # \x7f",
                           "a = 1\r",
                           "\r",
                           "a = [1 2]",
                           "a = [,]",
                           "a = [1,,2]",
                           "a = {b=1,}",
                           "a = {b=1 c=2}",
                           "a = {\n}",
                           "\"\"\"a\"\"\" = 1",
                           "a..b = 1",
                           "a.  = 1",
                           "a = \xE2\x80\xA8"}) {
    const std::string said = toml_complaint(text);
    EXPECT_EQ(said.substr(0, 7), "a.toml:") << text;
    EXPECT_LT(said.size(), 200U);
  }
}

TEST(TomlReader, RefusesWhatIsNotUtf8OrTooLong) {
  EXPECT_EQ(toml_complaint("a = 1\nb = '\xff'"),
            "a.toml:2: is not UTF-8; save the file as UTF-8, or name another one");
  EXPECT_NE(toml_complaint(std::string("a = 1\0", 6)).find("zero byte"), std::string::npos);
  EXPECT_NE(toml_complaint(std::string(300, 'a') + " = 1").find("more than 256 bytes"),
            std::string::npos);
  EXPECT_NE(
      toml_complaint("a = '" + std::string(200'000, 'b') + "'").find("more than 100000 bytes"),
      std::string::npos);
  std::string dotted, lists;
  for (int i = 0; i < 10'001; ++i) {
    dotted += "a" + std::to_string(i) + ".b = 1\n";
    lists += "[[a" + std::to_string(i) + "]]\n";
  }
  EXPECT_NE(toml_complaint(dotted).find("more than 10000 dotted keys"), std::string::npos);
  EXPECT_NE(toml_complaint(lists).find("more than 500 different lists"), std::string::npos);
  TomlLimits few;
  few.bytes = 5;
  EXPECT_NE(test::error_message([&] { check_toml("a =  1", "a.toml", few); }), "");
  few = {};
  few.values = 3;
  EXPECT_NE(test::error_message([&] { check_toml("a = [1, 2, 3]", "a.toml", few); }), "");
}

}  // namespace
}  // namespace vernier::internal
