// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/program/text_table.h"

#include <algorithm>
#include <utility>

#include "calib/base/text_lines.h"
#include "calib/base/utf8.h"

namespace vernier::cli {

using namespace vernier::internal;

namespace {

constexpr std::size_t column_gap = 2;  ///< between columns

/// Where each character begins, and the end.
std::vector<std::size_t> characters(std::string_view text) {
  std::vector<std::size_t> starts;
  for (std::size_t at = 0; at < text.size();) {
    starts.push_back(at);
    at += std::max<std::size_t>(1, utf8_length(text, at));
  }
  starts.push_back(text.size());
  return starts;
}

std::size_t width_of(const TextColumn& column) {
  std::size_t width = text_width(column.head);
  for (const std::string& cell : column.cells) width = std::max(width, text_width(cell));
  return width;
}

bool is_left(const TextColumn& column) {
  return column.is_key && !std::all_of(column.cells.begin(), column.cells.end(),
                                       [](const std::string& c) { return to_real(c).has_value(); });
}

/// Cuts the key columns, the widest first, until they fit.
void fit_keys(std::vector<TextColumn>& keys, std::size_t room) {
  constexpr std::size_t least = 6;
  std::vector<std::size_t> widths;
  std::size_t all = 0;
  for (const TextColumn& key : keys) {
    widths.push_back(width_of(key));
    all += widths.back() + column_gap;
  }
  while (all > room) {
    const auto widest = std::max_element(widths.begin(), widths.end());
    if (*widest <= least) break;
    --*widest;
    --all;
  }
  for (std::size_t k = 0; k < keys.size(); ++k) {
    keys[k].head = middle_cut(keys[k].head, widths[k]);
    for (std::string& cell : keys[k].cells) cell = middle_cut(cell, widths[k]);
  }
}

std::string padded(const std::string& text, std::size_t width, bool left) {
  const std::string room(width - std::min(width, text_width(text)), ' ');
  return left ? text + room : room + text;
}

std::string lines_of(const std::vector<const TextColumn*>& columns) {
  std::string text;
  const std::size_t rows = columns.empty() ? 0 : columns[0]->cells.size();
  for (std::size_t row = 0; row <= rows; ++row) {  // the first is the head
    std::string line;
    for (const TextColumn* column : columns) {
      if (!line.empty()) line += std::string(column_gap, ' ');
      const std::string& cell = row == 0 ? column->head : column->cells[row - 1];
      line += padded(cell, width_of(*column), is_left(*column));
    }
    line.erase(line.find_last_not_of(' ') + 1);
    text += line + "\n";
  }
  return text;
}

}  // namespace

std::size_t text_width(std::string_view text) { return characters(text).size() - 1; }

std::string middle_cut(std::string_view text, std::size_t width) {
  const std::vector<std::size_t> starts = characters(text);
  const std::size_t count = starts.size() - 1;
  if (count <= width) return std::string(text);
  const std::size_t tail = (width - 1) / 2, head = width - 1 - tail;
  return std::string(text.substr(0, starts[head])) + "…" +
         std::string(text.substr(starts[count - tail]));
}

std::string text_table(std::vector<TextColumn> columns, std::size_t width) {
  std::vector<TextColumn> keys, figures;
  for (TextColumn& column : columns) {
    (column.is_key ? keys : figures).push_back(std::move(column));
  }
  fit_keys(keys, width * 11 / 20);
  std::vector<const TextColumn*> key_columns;
  std::size_t taken_by_keys = 0;
  for (const TextColumn& key : keys) {
    key_columns.push_back(&key);
    taken_by_keys += width_of(key) + column_gap;
  }
  std::string text;
  for (std::size_t next = 0; next < figures.size() || text.empty();) {
    const bool is_first = text.empty();
    std::vector<const TextColumn*> part = key_columns;
    if (!is_first && part.size() > 1) part.resize(1);
    std::size_t taken = is_first || part.empty() ? taken_by_keys : width_of(*part[0]) + column_gap;
    do {
      if (next == figures.size()) break;
      taken += width_of(figures[next]) + column_gap;
      part.push_back(&figures[next++]);
    } while (next < figures.size() && taken + width_of(figures[next]) <= width);
    if (!is_first) text += "\n";
    text += lines_of(part);
  }
  return text;
}

}  // namespace vernier::cli
