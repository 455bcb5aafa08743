// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/base/column_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "calib/base/byte_order.h"
#include "calib/base/file_in_progress.h"
#include "calib/base/numpy_array.h"
#include "calib/base/utf8.h"
#include "calib/error.h"

namespace vernier::internal {

namespace {

std::string csv_text(std::string_view text) {
  if (text.find_first_of(",\"\r\n") == std::string_view::npos) return std::string(text);
  std::string quoted = "\"";
  for (const char c : text) quoted.append(c == '"' ? 2 : 1, c);
  return quoted + "\"";
}

std::string csv_value(const ColumnValue& value) {
  if (const auto* real = std::get_if<double>(&value)) {
    return std::isnan(*real) ? std::string() : fmt::format("{}", *real);
  }
  if (const auto* whole = std::get_if<std::int64_t>(&value)) return fmt::format("{}", *whole);
  if (const auto* flag = std::get_if<bool>(&value)) return *flag ? "true" : "false";
  return csv_text(std::get<std::string>(value));
}

std::string numpy_type(const Column& column) {
  switch (column.kind) {
    case ColumnKind::text:
      return fmt::format("<U{}", column.characters);
    case ColumnKind::whole:
      return "<i8";
    case ColumnKind::boolean:
      return "|b1";
    case ColumnKind::real:
      break;
  }
  return "<f8";
}

/// A name as a Python literal.
std::string python_text(std::string_view text) {
  std::string quoted = "'";
  for (const char c : text) {
    if (c == '\'' || c == '\\') quoted += '\\';
    quoted += c;
  }
  return quoted + "'";
}

std::string description_of(const std::vector<Column>& columns, std::size_t rows) {
  std::string text = "{'descr': [";
  for (const Column& column : columns) {
    text += fmt::format("({}, '{}'), ", python_text(column.name), numpy_type(column));
  }
  return text + fmt::format("], 'fortran_order': False, 'shape': ({},), }}", rows);
}

/// The code point of a valid character of UTF-8.
std::uint32_t code_point(std::string_view character) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(character[i]); };
  if (character.size() == 1) return byte(0);
  std::uint32_t code = byte(0) & (0xffU >> (character.size() + 1));
  for (std::size_t i = 1; i < character.size(); ++i) code = code << 6U | (byte(i) & 0x3fU);
  return code;
}

/// UTF-32, filled up with zeros. What is no UTF-8 becomes U+FFFD.
void append_utf32(std::string& bytes, std::string_view text, std::size_t characters) {
  constexpr std::uint32_t replacement = 0xfffd;
  std::size_t at = 0;
  for (std::size_t i = 0; i < characters; ++i) {
    std::uint32_t code = 0;
    if (at < text.size()) {
      const std::size_t length = utf8_length(text, at);
      code = length > 0 ? code_point(text.substr(at, length)) : replacement;
      at += std::max<std::size_t>(1, length);
    }
    append_number(bytes, code, false);
  }
}

}  // namespace

ColumnFile::Format ColumnFile::format_of(const std::string& name) {
  if (name.ends_with(".csv")) return Format::csv;
  if (name.ends_with(".npy")) return Format::npy;
  throw Error(name, "has neither of the endings .csv and .npy", "name the output results.csv");
}

ColumnFile::ColumnFile(FileInProgress& file,
                       Format format,
                       std::vector<Column> columns,
                       std::size_t rows)
    : file_(file), format_(format), columns_(std::move(columns)) {
  for (Column& column : columns_) column.characters = std::max<std::size_t>(1, column.characters);
  if (format_ == Format::npy) {
    file_.append(numpy_head(description_of(columns_, rows)));
    return;
  }
  std::string line;
  for (const Column& column : columns_) {
    if (!line.empty()) line += ',';
    line += csv_text(column.name);
  }
  file_.append(line + "\n");
}

void ColumnFile::add(const std::vector<ColumnValue>& row) {
  const auto kind_of = [](const ColumnValue& value) {
    constexpr ColumnKind kinds[] = {ColumnKind::real, ColumnKind::whole, ColumnKind::boolean,
                                    ColumnKind::text};
    return kinds[value.index()];
  };
  bool fits = row.size() == columns_.size();
  for (std::size_t i = 0; fits && i < row.size(); ++i) fits = kind_of(row[i]) == columns_[i].kind;
  if (!fits) throw Error(file_.target().string(), "a row does not fit the table's columns", "");
  format_ == Format::csv ? add_csv(row) : add_npy(row);
}

void ColumnFile::add_csv(const std::vector<ColumnValue>& row) {
  std::string line;
  for (std::size_t i = 0; i < row.size(); ++i) {
    if (i > 0) line += ',';
    line += csv_value(row[i]);
  }
  file_.append(line + "\n");
}

void ColumnFile::add_npy(const std::vector<ColumnValue>& row) {
  std::string bytes;
  for (std::size_t i = 0; i < row.size(); ++i) {
    if (const auto* real = std::get_if<double>(&row[i])) {
      append_number(bytes, *real, false);
    } else if (const auto* whole = std::get_if<std::int64_t>(&row[i])) {
      append_number(bytes, *whole, false);
    } else if (const auto* flag = std::get_if<bool>(&row[i])) {
      bytes += *flag ? '\x01' : '\x00';
    } else {
      append_utf32(bytes, std::get<std::string>(row[i]), columns_[i].characters);
    }
  }
  file_.append(bytes);
}

}  // namespace vernier::internal
