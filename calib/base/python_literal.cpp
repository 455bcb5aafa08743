// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/base/python_literal.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cstddef>
#include <system_error>
#include <utility>

#include "calib/base/shown_text.h"
#include "calib/base/text_lines.h"
#include "calib/base/utf8.h"
#include "calib/error.h"

namespace vernier::internal {
namespace {

// A cameramodel with the data of its optimisation has some MB of text, and a hundred values.
constexpr std::size_t most_bytes = 64'000'000, most_values = 100'000, most_keys = 1'000,
                      most_word_bytes = 1'000;

class Parser {
 public:
  Parser(std::string_view text, const std::string& place) : text_(text), place_(place) {}

  PythonLiteral whole() {
    PythonLiteral value = literal(0);
    skip();
    if (at_ < text_.size()) fail("has something after its end");
    return value;
  }

 private:
  [[noreturn]] void fail(const std::string& fault) const {
    throw Error(place_ + ":" + std::to_string(line_), fault, "");
  }

  void advance() { line_ += text_[at_++] == '\n'; }

  /// Skips blanks and comments.
  void skip() {
    while (at_ < text_.size()) {
      if (text_[at_] == '#') {
        while (at_ < text_.size() && text_[at_] != '\n') ++at_;
      } else if (std::isspace(static_cast<unsigned char>(text_[at_]))) {
        advance();
      } else {
        return;
      }
    }
  }

  char next() {
    skip();
    if (at_ >= text_.size()) fail("ends too early: it was cut off");
    return text_[at_];
  }

  bool take(char c) {
    if (next() != c) return false;
    ++at_;
    return true;
  }

  bool text_begins() const {
    const auto quote = [&](std::size_t i) {
      return i < text_.size() && (text_[i] == '\'' || text_[i] == '"');
    };
    return quote(at_) || ((text_[at_] == 'b' || text_[at_] == 'r') && quote(at_ + 1));
  }

  PythonLiteral literal(int depth) {
    if (depth > 32) fail("is nested more than 32 levels deep");
    if (++values_ > most_values) fail(fmt::format("holds more than {} values", most_values));
    const char c = next();
    PythonLiteral value;
    value.line = line_;
    if (c == '{') {
      dictionary(value, depth);
    } else if (c == '[' || c == '(') {
      list(value, c == '[' ? ']' : ')', depth);
    } else if (text_begins()) {
      value.kind = PythonLiteral::Kind::text;
      value.text = quoted();
    } else {
      bare(value);
    }
    return value;
  }

  void dictionary(PythonLiteral& value, int depth) {
    value.kind = PythonLiteral::Kind::dictionary;
    ++at_;
    while (!take('}')) {
      if (!text_begins()) fail("has a key that is not a quoted string");
      std::string key = quoted();
      if (value.find(key)) fail("has the key '" + shortened(key) + "' twice");
      if (value.entries.size() >= most_keys) {
        fail(fmt::format("holds more than {} keys", most_keys));
      }
      if (!take(':')) fail("has no colon after the key '" + shortened(key) + "'");
      value.entries.push_back({std::move(key), literal(depth + 1)});
      if (!take(',') && next() != '}') fail("has no comma between two entries");
    }
  }

  void list(PythonLiteral& value, char close, int depth) {
    value.kind = PythonLiteral::Kind::list;
    ++at_;
    while (!take(close)) {
      value.items.push_back(literal(depth + 1));
      if (!take(',') && next() != close) fail("has no comma between two values");
    }
  }

  /// One string. Adjacent strings are joined, as in Python.
  std::string quoted() {
    std::string joined;
    while (next(), text_begins()) {
      if (text_[at_] != '\'' && text_[at_] != '"') ++at_;
      const char quote = text_[at_++];
      const std::size_t begin = at_;
      while (at_ < text_.size() && text_[at_] != quote) {
        if (text_[at_] == '\n') fail("has a quote that is not closed");
        if (text_[at_] == '\\') ++at_;
        if (at_ < text_.size()) advance();
      }
      if (at_ >= text_.size()) fail("ends too early: a quote is not closed");
      joined += text_.substr(begin, at_++ - begin);
    }
    return joined;
  }

  /// A number or a bare word.
  void bare(PythonLiteral& value) {
    const std::size_t begin = at_;
    while (at_ < text_.size() &&
           (std::isalnum(static_cast<unsigned char>(text_[at_])) || text_[at_] == '_' ||
            text_[at_] == '.' || text_[at_] == '+' || text_[at_] == '-')) {
      ++at_;
    }
    value.text = text_.substr(begin, at_ - begin);
    if (value.text.empty())
      fail("has a " +
           in_quotes(text_.substr(at_, std::max<std::size_t>(1, utf8_length(text_, at_)))) +
           " where a value is expected");
    if (value.text.size() > most_word_bytes) {
      fail(fmt::format("holds a number or word of more than {} bytes", most_word_bytes));
    }
    const char* first = value.text.data() + (value.text[0] == '+');
    const char* last = value.text.data() + value.text.size();
    const auto parsed = std::from_chars(first, last, value.number);
    const bool all = parsed.ptr == last;
    if (parsed.ec == std::errc::result_out_of_range && all) {
      const auto small = to_real(value.text);
      if (!small) fail(in_quotes(value.text) + " is not a number that a double can hold");
      value.number = *small;
    }
    const bool number = all && parsed.ec != std::errc::invalid_argument;
    value.kind = number ? PythonLiteral::Kind::number : PythonLiteral::Kind::word;
  }

  std::string_view text_;
  const std::string& place_;
  std::size_t at_ = 0;
  int line_ = 1;
  std::size_t values_ = 0;
};

}  // namespace

const PythonLiteral* PythonLiteral::find(std::string_view key) const {
  for (const auto& [name, value] : entries) {
    if (name == key) return &value;
  }
  return nullptr;
}

PythonLiteral parse_python_literal(std::string_view text, const std::string& place) {
  check_text(text, place, "a Python literal", most_bytes);
  return Parser(text, place).whole();
}

}  // namespace vernier::internal
