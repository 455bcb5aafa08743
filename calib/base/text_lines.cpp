// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/base/text_lines.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstddef>

#include "calib/base/atomic_file.h"
#include "calib/error.h"

namespace vernier::internal {
namespace {

template <class Number>
Number parse(std::string_view field, const std::string& place, std::string_view what) {
  while (!field.empty() && field.front() == ' ') field.remove_prefix(1);
  while (!field.empty() && field.back() == ' ') field.remove_suffix(1);
  Number value{};
  const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
  if (error != std::errc() || end != field.data() + field.size()) {
    throw Error(place, fmt::format("{} is \"{}\", not a number", what, field),
                "correct or remove the line");
  }
  return value;
}

}  // namespace

TextLines::TextLines(const std::filesystem::path& file) : file_(file), text_(read_whole(file)) {}

bool TextLines::next(std::string_view& line) {
  if (begin_ >= text_.size()) return false;
  const std::size_t end = std::min(text_.find('\n', begin_), text_.size());
  line = std::string_view(text_).substr(begin_, end - begin_);
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  begin_ = end + 1;
  ++number_;
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
  if (text.starts_with('+') && !text.starts_with("+-")) text.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return {};
  return value;
}

double parse_real(std::string_view field, const std::string& place, std::string_view what) {
  return parse<double>(field, place, what);
}

int parse_whole(std::string_view field, const std::string& place, std::string_view what) {
  return parse<int>(field, place, what);
}

}  // namespace vernier::internal
