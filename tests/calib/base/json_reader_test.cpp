// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/base/json_reader.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <nlohmann/json.hpp>

#include "tests/support/error_message.h"

namespace vernier::internal {
namespace {

std::string complaint(const std::string& text, const JsonLimits& limits = {}) {
  return test::error_message([&] { parse_json(text, "a.json", limits); });
}

std::string nested(std::size_t depth, const std::string& open, const std::string& close) {
  std::string text;
  for (std::size_t i = 0; i < depth; ++i) text += open;
  text += "1";
  for (std::size_t i = 0; i < depth; ++i) text += close;
  return text;
}

TEST(JsonReader, ReadsWhatItsLibraryWrites) {
  const std::string text =
      R"({"b":[1,-2,1.5e-300,true,false,null,""],"a":{"b":{},"c":[]},"é\u0001\"":18446744073709551615})";
  const auto json = parse_json(text, "a.json");
  EXPECT_EQ(json, nlohmann::ordered_json::parse(text));
  EXPECT_EQ(parse_json(json.dump(), "a.json").dump(), json.dump());
  EXPECT_EQ(json.items().begin().key(), "b");  // the file's order
}

TEST(JsonReader, RefusesDepth) {
  EXPECT_EQ(complaint(nested(64, "[", "]")), "");
  EXPECT_EQ(complaint(nested(65, "[", "]")),
            "a.json:1: is nested more than 64 levels deep; name another file, or flatten it");
  for (const std::size_t depth : {1'000U, 100'000U, 1'000'000U}) {
    EXPECT_NE(complaint(nested(depth, "{\"a\":\n", "}")).find("a.json:65: is nested"),
              std::string::npos);
    EXPECT_NE(complaint(std::string(depth, '[')).find("is nested"), std::string::npos);
  }
}

TEST(JsonReader, RefusesAKeyGivenTwiceInOneObject) {
  EXPECT_EQ(complaint("{\"a\": 1,\n\"b\": {\"a\": 2}}"), "");
  EXPECT_EQ(complaint("{\"a\": 1,\n\"b\": 2,\n\"a\": 3\n}"),
            "a.json:4: the object that ends here has the key \"a\" twice; keep one");
  EXPECT_NE(complaint(R"({"a": 1, "\u0061": 2})"), "");
}

TEST(JsonReader, NamesNumbersThatJsonDoesNotHave) {
  for (const char* text : {"[1, NaN]", "[-Infinity]", "{\"a\": nan}", "[inf, 2]"}) {
    EXPECT_EQ(complaint(text),
              "a.json:1: holds NaN or Infinity, which JSON does not have; leave the value out")
        << text;
  }
  EXPECT_EQ(complaint("[1, oops]"),
            "a.json:1: is not JSON: a comma, quote or bracket is wrong here; correct it");
  // Of a line the column.
  EXPECT_EQ(test::error_message([] { parse_json_line("{\"a\": [1, oops]}", "b.jsonl:7"); }),
            "b.jsonl:7:11: is not JSON: a comma, quote or bracket is wrong here; correct it");
}

TEST(JsonReader, RefusesNumbersThatNoDoubleHolds) {
  EXPECT_EQ(complaint("[1,\n1e309]"),
            "a.json:2: \"1e309\" is not a number that a double can hold; correct it");
  EXPECT_NE(complaint("[-1e999]"), "");
  EXPECT_NE(complaint("[" + std::string(500, '9') + "]"), "");
  EXPECT_NE(complaint("[0." + std::string(5'000, '1') + "]").find("5002 digits"),
            std::string::npos);
  EXPECT_EQ(parse_json("[1e-400]", "a.json").dump(), "[0.0]");
  for (const char* word : {"[NaN]", "[nan]", "[Infinity]", "[01]", "[+1]", "[0x10]", "[1_000]"}) {
    EXPECT_NE(complaint(word), "") << word;
  }
}

TEST(JsonReader, RefusesWhatIsNotOneWholeValueInUtf8) {
  EXPECT_EQ(complaint(" \n"), "a.json: is empty; write it again, or name another file");
  EXPECT_EQ(complaint("{\"a\":\n[1, 2"),
            "a.json:2: is not JSON: it ends too early; write it again");
  EXPECT_EQ(complaint("{\"a\": 1}\n}"),
            "a.json:2: is not JSON: a comma, quote or bracket is wrong here; correct it");
  EXPECT_EQ(complaint("[1]\n[2]").substr(0, 9), "a.json:2:");
  EXPECT_EQ(complaint("[\n\"\xff\"]"),
            "a.json:2: is not UTF-8; save the file as UTF-8, or name another one");
  EXPECT_NE(complaint("[\"\xed\xa0\x80\"]").find("is not UTF-8"), std::string::npos);
  EXPECT_NE(complaint(std::string("[1]\0", 4)).find("zero byte"), std::string::npos);
  EXPECT_NE(complaint(R"(["\ud800"])"), "");
  const std::string whole = R"({"a": [1, {"b": "c"}], "d": 1.5})";
  for (std::size_t cut = 0; cut < whole.size(); ++cut)
    EXPECT_NE(complaint(whole.substr(0, cut)), "");
}

TEST(JsonReader, RefusesWhatIsTooLong) {
  JsonLimits few;
  few.values = 3;
  few.keys = 2;
  few.text_bytes = 4;
  few.bytes = 40;
  EXPECT_EQ(complaint("[1,2]", few), "");
  EXPECT_NE(complaint("[1,2,3]", few).find("more than 3 values"), std::string::npos);
  EXPECT_NE(complaint(R"({"a":1,"b":2,"c":3})", few).find("more than 2 keys"), std::string::npos);
  EXPECT_NE(complaint("[\"12345\"]", few).find("a text of 5 bytes"), std::string::npos);
  EXPECT_NE(complaint("{\"12345\":1}", few).find("a key of 5 bytes"), std::string::npos);
  EXPECT_NE(complaint("[1" + std::string(40, ' ') + "]", few).find("MB long"), std::string::npos);
}

}  // namespace
}  // namespace vernier::internal
