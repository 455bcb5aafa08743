// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace vernier::cli {

/// Number of characters of UTF-8 text; those of bytes that are none count one each.
std::size_t text_width(std::string_view text);

/// The text cut in the middle, with "…", to at most `width` characters, which is at least 3.
std::string middle_cut(std::string_view text, std::size_t width);

/// A column of a table for the terminal.
struct TextColumn {
  std::string head;
  std::vector<std::string> cells;
  bool is_key = false;  ///< names the rows: aligned to the left unless all cells are numbers
};

/// Lines of columns, numbers aligned to the right, at most `width` characters wide: texts of key
/// columns are cut where together they take more than 55 % of it, and columns without room follow
/// in a further table, with the first of the key columns. All columns have as many cells.
std::string text_table(std::vector<TextColumn> columns, std::size_t width = 80);

}  // namespace vernier::cli
