// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/base/toml_grammar.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <set>
#include <system_error>

#include "calib/base/shown_text.h"
#include "calib/base/text_lines.h"
#include "calib/base/utf8.h"
#include "calib/error.h"

namespace vernier::internal {
namespace {

bool is_digit_of(char c, unsigned base) {
  if (c >= '0' && c <= '9') return static_cast<unsigned>(c - '0') < base;
  return base == 16 && ((c >= 'a' && c <= 'f') || (c >= 'A' && c <= 'F'));
}

bool is_bare(char c) {
  return is_digit_of(c, 10) || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_' ||
         c == '-';
}

/// A control character other than a tab.
bool is_toml_control(char c) {
  return (static_cast<unsigned char>(c) < 0x20U && c != '\t') || c == 0x7f;
}

/// Takes digits with single underscores between them; false if there are none.
bool take_digits(std::string_view& rest, unsigned base, std::string& digits) {
  const std::size_t before = digits.size();
  while (!rest.empty()) {
    if (is_digit_of(rest[0], base)) {
      digits += rest[0];
    } else if (rest[0] != '_' || digits.size() == before || rest.size() < 2 ||
               !is_digit_of(rest[1], base)) {
      break;
    }
    rest.remove_prefix(1);
  }
  return digits.size() > before;
}

/// Whether a word is a decimal number of TOML; `plain` is then the number without underscores.
bool is_decimal(std::string_view word, std::string& plain, bool& whole) {
  plain.clear();
  if (word.starts_with('+') || word.starts_with('-')) {
    if (word[0] == '-') plain = "-";
    word.remove_prefix(1);
  }
  const bool zero =
      word.size() > 1 && word[0] == '0' && (is_digit_of(word[1], 10) || word[1] == '_');
  if (zero || !take_digits(word, 10, plain)) return false;
  whole = word.empty();
  if (word.starts_with('.')) {
    word.remove_prefix(1);
    plain += '.';
    if (!take_digits(word, 10, plain)) return false;
  }
  if (word.starts_with('e') || word.starts_with('E')) {
    word.remove_prefix(1);
    plain += 'e';
    if (word.starts_with('+') || word.starts_with('-')) {
      plain += word[0];
      word.remove_prefix(1);
    }
    if (!take_digits(word, 10, plain)) return false;
  }
  return word.empty();
}

class TomlGrammar {
 public:
  TomlGrammar(std::string_view text, const std::string& place, const TomlLimits& limits)
      : text_(text), place_(place), limits_(limits) {}

  void check() {
    while (skip_blank_lines(), at_ < text_.size()) {
      if (peek() == '[') {
        header();
      } else {
        pair(header_depth_);
      }
      end_line();
    }
  }

 private:
  [[noreturn]] void fail(const std::string& fault,
                         const std::string& remedy = "correct the syntax") const {
    throw Error(fmt::format("{}:{}", place_, line_of(text_, std::min(at_, text_.size()))), fault,
                remedy);
  }

  /// What is here, for messages.
  std::string here() const {
    if (at_ >= text_.size()) return "the end of the file";
    if (peek() == '\n' || peek() == '\r') return "the end of the line";
    return in_quotes(text_.substr(at_, std::max<std::size_t>(1, utf8_length(text_, at_))));
  }

  char peek(std::size_t ahead = 0) const {
    return at_ + ahead < text_.size() ? text_[at_ + ahead] : '\0';
  }

  bool take(std::string_view word) {
    if (text_.substr(at_, word.size()) != word) return false;
    at_ += word.size();
    return true;
  }

  void skip_blanks() {
    while (peek() == ' ' || peek() == '\t') ++at_;
  }

  bool take_line_end() { return take("\n") || take("\r\n"); }

  void skip_comment() {
    if (peek() != '#') return;
    while (at_ < text_.size() && peek() != '\n' && text_.substr(at_, 2) != "\r\n") {
      if (is_toml_control(peek())) fail("not TOML: a comment holds a control character");
      ++at_;
    }
  }

  void skip_blank_lines() {
    do {
      skip_blanks();
      skip_comment();
    } while (take_line_end());
  }

  void end_line() {
    skip_blanks();
    skip_comment();
    if (at_ < text_.size() && !take_line_end()) {
      fail("not TOML: " + here() + " follows where the line should end");
    }
  }

  void check_depth(std::size_t depth) const {
    if (depth <= limits_.depth) return;
    fail(fmt::format("is nested more than {} levels deep", limits_.depth), "flatten it");
  }

  void header() {
    const bool list = text_.substr(at_, 2) == "[[";
    at_ += list ? 2 : 1;
    const std::size_t begin = at_;
    header_depth_ = key();
    const std::string_view name = text_.substr(begin, at_ - begin);
    if (!take(list ? "]]" : "]")) fail("not TOML: a header has " + here() + " instead of \"]\"");
    check_depth(header_depth_ + (list ? 1 : 0));
    if (!list) return;
    ++header_depth_;
    lists_.emplace(name);
    if (lists_.size() > limits_.lists_of_tables) {
      fail(fmt::format("holds more than {} different lists of tables", limits_.lists_of_tables),
           "split the file");
    }
  }

  /// Takes a key with the blanks around it; returns the number of its parts.
  std::size_t key() {
    std::size_t parts = 0;
    do {
      skip_blanks();
      key_part();
      check_depth(++parts);
      skip_blanks();
    } while (take("."));
    if (parts > 1 && ++dotted_keys_ > limits_.dotted_keys) {
      fail(fmt::format("holds more than {} dotted keys", limits_.dotted_keys), "use tables");
    }
    return parts;
  }

  void key_part() {
    const std::size_t begin = at_;
    if (peek() == '"' || peek() == '\'') {
      if (text_.substr(at_, 3) == "\"\"\"" || text_.substr(at_, 3) == "'''") {
        fail("not TOML: a key cannot have several lines");
      }
      text();
    } else {
      while (is_bare(peek())) ++at_;
    }
    if (at_ == begin) fail("not TOML: a key is expected, not " + here());
    if (at_ - begin > limits_.key_bytes) {
      fail(fmt::format("holds a key of more than {} bytes", limits_.key_bytes), "shorten it");
    }
  }

  void pair(std::size_t depth) {
    const std::size_t parts = key();
    if (!take("=")) fail("not TOML: a key is followed by " + here() + " instead of \"=\"");
    skip_blanks();
    value(depth + parts);
  }

  void value(std::size_t depth) {
    check_depth(depth);
    if (++values_ > limits_.values) {
      fail(fmt::format("holds more than {} values", limits_.values), "split the file");
    }
    if (peek() == '[') return list(depth);
    if (peek() == '{') return inline_table(depth);
    if (peek() == '"' || peek() == '\'') return text();
    word();
  }

  void list(std::size_t depth) {
    ++at_;
    while (skip_blank_lines(), !take("]")) {
      value(depth + 1);
      skip_blank_lines();
      if (take(",")) continue;
      if (peek() != ']') fail("not TOML: a list has " + here() + " instead of a comma or \"]\"");
    }
  }

  void inline_table(std::size_t depth) {
    ++at_;
    skip_blanks();
    if (take("}")) return;
    do {
      pair(depth);
      skip_blanks();
    } while (take(","));
    if (!take("}")) fail("not TOML: a table has " + here() + " instead of a comma or \"}\"");
  }

  /// A text in any of the four kinds of quotes.
  void text() {
    const char quote = peek();
    const std::string three(3, quote);
    const bool lines = take(three);
    if (!lines) ++at_;
    const std::size_t begin = at_;
    while (at_ < text_.size()) {
      if (at_ - begin > limits_.text_bytes) {
        fail(fmt::format("holds a text of more than {} bytes", limits_.text_bytes), "shorten it");
      }
      if (lines ? take(three) : take(three.substr(0, 1))) {
        for (int more = 0; lines && more < 2 && peek() == quote; ++more) ++at_;
        return;
      }
      if (lines && take_line_end()) continue;
      if (is_toml_control(peek())) break;
      if (peek() == '\\' && quote == '"') {
        escape(lines);
      } else {
        ++at_;
      }
    }
    const bool control = at_ < text_.size() && peek() != '\n' && peek() != '\r';
    fail(control ? "not TOML: a text holds a control character" : "not TOML: a text has no end",
         control ? "write it as \\u001b" : "close its quotes");
  }

  void escape(bool lines) {
    const std::size_t begin = at_++;
    const char kind = peek();
    const std::size_t digits = kind == 'u' ? 4 : kind == 'U' ? 8 : 0;
    if (digits > 0) {
      ++at_;
      std::uint32_t code = 0;
      const std::string_view number = text_.substr(at_, digits);
      const auto* const end = number.data() + number.size();
      const auto read = std::from_chars(number.data(), end, code, 16);
      const bool scalar = code < 0xD800U || (code > 0xDFFFU && code <= 0x10FFFFU);
      if (number.size() == digits && read.ec == std::errc() && read.ptr == end && scalar) {
        at_ += digits;
        return;
      }
    } else if (kind != '\0' && std::string_view("btnfr\"\\").find(kind) != std::string_view::npos) {
      ++at_;
      return;
    } else if (lines) {
      skip_blanks();
      if (take_line_end()) return joined_line();
    }
    at_ = begin;
    fail("not TOML: a text holds an unknown escape " + in_quotes(text_.substr(at_, 2)),
         "write \\\\ for a backslash");
  }

  /// What follows a backslash at a line's end: toml++ 3.3 does not know which characters beyond
  /// ASCII are blank.
  void joined_line() {
    do {
      skip_blanks();
    } while (take_line_end());
    if ((static_cast<unsigned char>(peek()) & 0x80U) != 0) {
      fail("holds a backslash at the end of a line before a character beyond ASCII",
           "leave the backslash out, or join the lines");
    }
  }

  /// A number, true or false.
  void word() {
    const std::size_t begin = at_;
    while (is_bare(peek()) || peek() == '+' || peek() == '.' || peek() == ':') ++at_;
    const std::string_view word = text_.substr(begin, at_ - begin);
    if (word.empty()) fail("not TOML: a value is expected, not " + here());
    if (word.size() > limits_.number_bytes) {
      fail(fmt::format("holds a number of more than {} bytes", limits_.number_bytes), "shorten it");
    }
    if (word == "true" || word == "false") return;
    const std::string_view unsigned_word =
        word.starts_with('+') || word.starts_with('-') ? word.substr(1) : word;
    if (unsigned_word == "inf" || unsigned_word == "nan") return;
    if (word.starts_with("0x") || word.starts_with("0o") || word.starts_with("0b")) {
      return based_number(word);
    }
    std::string plain;
    bool whole = false;
    if (!is_decimal(word, plain, whole)) {
      fail("not TOML: " + in_quotes(word) + " is neither a number nor true or false",
           "put a text in quotes");
    }
    const auto real = to_real(plain);
    if (!real || !std::isfinite(*real)) {
      fail(in_quotes(word) + " is not a number that a double can hold", "correct it");
    }
    if (whole) check_whole(word, plain, 10);
  }

  void based_number(std::string_view word) const {
    const unsigned base = word[1] == 'x' ? 16 : word[1] == 'o' ? 8 : 2;
    std::string_view rest = word.substr(2);
    std::string digits;
    if (!take_digits(rest, base, digits) || !rest.empty()) {
      fail("not TOML: " + in_quotes(word) + " is not a number", "correct it");
    }
    check_whole(word, digits, static_cast<int>(base));
  }

  void check_whole(std::string_view word, const std::string& digits, int base) const {
    std::int64_t number = 0;
    const auto read = std::from_chars(digits.data(), digits.data() + digits.size(), number, base);
    if (read.ec != std::errc()) {
      fail(in_quotes(word) + " is too large a whole number", "correct it");
    }
  }

  std::string_view text_;
  const std::string& place_;
  const TomlLimits& limits_;
  std::size_t at_ = 0;
  std::size_t header_depth_ = 0, values_ = 0, dotted_keys_ = 0;
  std::set<std::string, std::less<>> lists_;
};

}  // namespace

void check_toml(std::string_view text, const std::string& place, const TomlLimits& limits) {
  check_text(text, place, "a TOML file", limits.bytes);
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);  // a byte order mark
  TomlGrammar(text, place, limits).check();
}

}  // namespace vernier::internal
