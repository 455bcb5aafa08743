// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/base/yaml_reader.h"

#include <gtest/gtest.h>

#include <cstddef>

#include "tests/support/error_message.h"
#include "tests/support/texts.h"

namespace vernier::internal {
namespace {

std::string yaml_complaint(const std::string& text, const YamlLimits& limits = {}) {
  return test::error_message([&] { parse_yaml(text, "a.yaml", limits); });
}

TEST(YamlReader, ReadsMapsListsAndScalarsWithTheirLines) {
  const YamlValue root = parse_yaml(
      "# comment\na: 1\nb: [x, 'y: z', \"\\u00e9\"]\nc:\n  d: ~\n  e:\n    - 1.5\n    - {f: g}\n",
      "a.yaml");
  ASSERT_EQ(root.kind, YamlValue::Kind::map);
  EXPECT_EQ(root.find("a")->text, "1");
  EXPECT_EQ(root.find("a")->line, 2U);
  EXPECT_EQ(root.find("b")->items.at(1).text, "y: z");
  EXPECT_EQ(root.find("b")->items.at(2).text, "é");
  EXPECT_EQ(root.find("c")->find("d")->kind, YamlValue::Kind::null);
  EXPECT_EQ(root.find("c")->find("e")->items.at(1).find("f")->text, "g");
  EXPECT_EQ(root.find("c")->find("e")->items.at(1).line, 8U);
  EXPECT_EQ(root.find("x"), nullptr);
}

TEST(YamlReader, ReadsOpenCvsFiles) {
  for (const char* begin : {"%YAML:1.0\n", "%YAML:1.0\n---\n", "%YAML 1.1\n---\n"}) {
    const YamlValue root = parse_yaml(std::string(begin) +
                                          "M1: !!opencv-matrix\n   rows: 1\n   cols: 3\n   dt: d\n"
                                          "   data: [ 1., .5,\n       -2.e-03 ]\n",
                                      "a.yaml");
    EXPECT_EQ(root.find("M1")->find("data")->items.at(2).text, "-2.e-03");
  }
}

TEST(YamlReader, RefusesDepth) {
  EXPECT_EQ(yaml_complaint(test::repeated("[", 32) + test::repeated("]", 32)), "");
  for (const std::size_t depth : {40U, 10'000U, 200'000U}) {
    EXPECT_EQ(yaml_complaint("a: " + test::repeated("[", depth)),
              "a.yaml:1: is nested more than 32 levels deep; name another file");
    EXPECT_NE(yaml_complaint(test::repeated("{a: ", depth)).find("is nested"), std::string::npos);
    EXPECT_NE(yaml_complaint(test::repeated("- ", depth)).find("is nested"), std::string::npos);
    EXPECT_NE(yaml_complaint(test::repeated("? ", depth)), "");
  }
}

TEST(YamlReader, RefusesAKeyGivenTwiceInOneMap) {
  EXPECT_EQ(yaml_complaint("a: 1\nb:\n  a: 2\n"), "");
  EXPECT_EQ(yaml_complaint("a: 1\nb: 2\n'a': 3\n"),
            "a.yaml:3: the key \"a\" appears a second time; keep one");
}

TEST(YamlReader, RefusesAliasesAndSeveralDocuments) {
  EXPECT_EQ(yaml_complaint("a: &x 1\nb: *x\n"),
            "a.yaml:2: aliases are not supported; write the value itself");
  EXPECT_EQ(yaml_complaint("a: 1\n---\nb: 1\n"),
            "a.yaml:2: a second document begins here; give one document a file");
  EXPECT_EQ(yaml_complaint("a: 1\n---\nb: *x\n"),
            "a.yaml:2: a second document begins here; give one document a file");
  EXPECT_EQ(yaml_complaint("a: 1\n---\n"), "");  // as ROS's "topic echo" ends a message
  EXPECT_EQ(yaml_complaint("%YAML 1.1\n%TAG !a! b\n---\na: 1\n"),
            "a.yaml:2: directives of tags are not supported; remove the line");
  EXPECT_NE(yaml_complaint("[a]: 1\n"), "");
}

TEST(YamlReader, RefusesWhatIsMalformedNotUtf8OrTooLong) {
  for (const char* text : {"a: [1, 2", "a: 'b", "a: 1\n b: 2\n", "a:\n\t- 1", "{a: 1", "a: %b", "@",
                           "a: b: c", "\x01", "!<", "%FOO", "a: !x!y z"}) {
    const std::string said = yaml_complaint(text);
    EXPECT_EQ(said.substr(0, 7), "a.yaml:") << text;
    EXPECT_LT(said.size(), 200U);
  }
  EXPECT_EQ(yaml_complaint("a: 1\nb: \xff"),
            "a.yaml:2: is not UTF-8; save the file as UTF-8, or name another one");
  YamlLimits few;
  few.values = 3;
  few.keys = 2;
  few.text_bytes = 4;
  EXPECT_NE(yaml_complaint("[1, 2, 3]", few).find("more than 3 values"), std::string::npos);
  EXPECT_NE(yaml_complaint("{a: 1, b: 2, c: 3}", few), "");
  EXPECT_NE(yaml_complaint("abcde", few).find("more than 4 bytes"), std::string::npos);
  few.bytes = 8;
  EXPECT_NE(yaml_complaint("a: 1     ", few).find("MB long"), std::string::npos);
}

TEST(YamlReader, TakesTimeAndMemoryByTheLength) {
  std::string text = "a: [";  // yaml-cpp took two seconds and 240 MB a megabyte
  while (text.size() < 8'000'000) text += "123.456, ";
  EXPECT_EQ(parse_yaml(text + "1]", "a.yaml").find("a")->items.size(), (text.size() - 4) / 9 + 1);
  text = "";
  for (int i = 0; i < 9'000; ++i) text += "key" + std::to_string(i) + ": {a: [1, 2], b: 'c'}\n";
  EXPECT_EQ(parse_yaml(text, "a.yaml").entries.size(), 9'000U);
}

}  // namespace
}  // namespace vernier::internal
