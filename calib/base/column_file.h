// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "calib/base/file_in_progress.h"

namespace vernier::internal {

/// What a column of a table holds.
enum class ColumnKind { text, whole, real, boolean };

struct Column {
  std::string name;
  ColumnKind kind = ColumnKind::real;
  std::size_t characters = 1;  ///< of the longest text, which a .npy file must know
};

/// A value of a table; not a number where there is none.
using ColumnValue = std::variant<double, std::int64_t, bool, std::string>;

/// Tables with named columns, row by row, so that a table of any length takes no memory.
///
/// CSV as of RFC 4180: a line of names, "." as decimal point, the fewest digits from which a number
/// is read back to the bit, an empty field where a real number is missing, true and false. NumPy's
/// .npy (NumPy Enhancement Proposal 1) with a structured type, one-dimensional and little-endian:
/// <f8, <i8, |b1, and <U with the column's number of characters.
class ColumnFile {
 public:
  enum class Format { csv, npy };

  /// By the ending of a name, .csv or .npy. Throws Error(`name`) for another one.
  static Format format_of(const std::string& name);

  /// Writes the head. `rows` is the number of rows that will follow.
  ColumnFile(FileInProgress& file, Format format, std::vector<Column> columns, std::size_t rows);

  /// One value for each column, of its kind; texts longer than their column are cut in a .npy
  /// file. Throws Error if a row has too many or too few, or another kind.
  void add(const std::vector<ColumnValue>& row);

 private:
  void add_csv(const std::vector<ColumnValue>& row);
  void add_npy(const std::vector<ColumnValue>& row);

  FileInProgress& file_;
  Format format_;
  std::vector<Column> columns_;
};

}  // namespace vernier::internal
