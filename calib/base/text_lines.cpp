// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/base/text_lines.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>

#include "calib/base/atomic_file.h"
#include "calib/base/shown_text.h"
#include "calib/error.h"

namespace vernier::internal {
namespace {

// The longest exact double has 1,075 digits, but no program writes them.
constexpr std::size_t most_number_bytes = 1'000;

std::string_view without_blanks(std::string_view field) {
  while (!field.empty() && field.front() == ' ') field.remove_prefix(1);
  while (!field.empty() && field.back() == ' ') field.remove_suffix(1);
  return field;
}

template <class Number>
Number number_or_error(const std::optional<Number>& value,
                       std::string_view field,
                       const std::string& place,
                       std::string_view what) {
  if (value) return *value;
  throw Error(place, fmt::format("{} is {}, not a number", what, in_quotes(field)),
              "correct or remove the line");
}

/// Whether a decimal number other than 0 is below 1 in magnitude, by its first digit and exponent.
bool is_small(std::string_view number) {
  const std::size_t end = std::min(number.find_first_of("eE"), number.size());
  const std::string_view digits = number.substr(0, end);
  long long exponent = 0;
  if (end < number.size()) {
    std::string_view said = number.substr(end + 1);
    if (said.starts_with('+')) said.remove_prefix(1);
    const auto read = std::from_chars(said.data(), said.data() + said.size(), exponent);
    if (read.ec != std::errc()) return said.starts_with('-');
    constexpr long long beyond_all = 1LL << 40;  // more than a text has digits
    exponent = std::clamp(exponent, -beyond_all, beyond_all);
  }
  const auto first = static_cast<long long>(digits.find_first_of("123456789"));
  const auto point = static_cast<long long>(std::min(digits.find('.'), digits.size()));
  return (first < point ? point - first - 1 : point - first) + exponent < 0;
}

}  // namespace

TextLines::TextLines(const std::filesystem::path& file, std::size_t longest_line)
    : file_(file), text_(read_whole(file)), longest_line_(longest_line) {
  constexpr std::string_view byte_order_mark = "\xef\xbb\xbf";
  if (text_.starts_with(byte_order_mark)) begin_ = byte_order_mark.size();
}

bool TextLines::next(std::string_view& line) {
  if (begin_ >= text_.size()) return false;
  const std::size_t end = std::min(text_.find('\n', begin_), text_.size());
  line = std::string_view(text_).substr(begin_, end - begin_);
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  begin_ = end + 1;
  ++number_;
  if (line.size() > longest_line_) {
    throw Error(place(), fmt::format("the line has {} bytes", line.size()),
                fmt::format("it may have {}; is this another kind of file?", longest_line_));
  }
  return true;
}

std::string TextLines::place() const { return file_.string() + ":" + std::to_string(number_); }

std::vector<std::string_view> split_fields(std::string_view line, std::string_view separators) {
  std::vector<std::string_view> fields;
  std::size_t begin = 0;
  const bool blanks = separators.find(' ') != std::string_view::npos;
  while (begin <= line.size()) {
    const std::size_t end = std::min(line.find_first_of(separators, begin), line.size());
    if (!blanks || end > begin) fields.push_back(line.substr(begin, end - begin));
    begin = end + 1;
  }
  return fields;
}

std::optional<double> to_real(std::string_view text) {
  if (text.size() > most_number_bytes) return {};
  if (text.starts_with('+') && !text.starts_with("+-")) text.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (end != text.data() + text.size()) return {};
  if (error == std::errc::result_out_of_range && is_small(text)) {
    return text.starts_with('-') ? -0.0 : 0.0;
  }
  if (error != std::errc()) return {};
  return value;
}

std::optional<double> to_finite(std::string_view text) {
  const std::optional<double> value = to_real(text);
  return value && std::isfinite(*value) ? value : std::nullopt;
}

double parse_real(std::string_view field, const std::string& place, std::string_view what) {
  const std::string_view text = without_blanks(field);
  return number_or_error(to_real(text), text, place, what);
}

int parse_whole(std::string_view field, const std::string& place, std::string_view what) {
  const std::string_view text = without_blanks(field);
  int value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool whole = error == std::errc() && end == text.data() + text.size();
  if (error == std::errc::result_out_of_range && end == text.data() + text.size()) {
    throw Error(place, fmt::format("{} is {}, too large a whole number", what, in_quotes(text)),
                "correct or remove the line");
  }
  return number_or_error(whole ? std::optional(value) : std::nullopt, text, place, what);
}

}  // namespace vernier::internal
