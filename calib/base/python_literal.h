// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

/// What Python's ast.literal_eval reads, as far as the files of mrcal and NumPy use it. Not
/// installed.
namespace vernier::internal {

/// A number, text (bytes too), list (tuple too), dictionary, or None, True, False as a word.
struct PythonLiteral {
  enum class Kind { number, text, word, list, dictionary };
  Kind kind = Kind::word;
  double number = 0;
  std::string text;  ///< of a text or word, escapes left as they are
  std::vector<PythonLiteral> items;
  std::vector<std::pair<std::string, PythonLiteral>> entries;  ///< of a dictionary
  int line = 0;

  /// The entry called `key`, or nothing. Repeated keys are refused on reading.
  const PythonLiteral* find(std::string_view key) const;
};

/// Reads one literal; comments (#) may stand anywhere. Throws Error("place:line").
PythonLiteral parse_python_literal(std::string_view text, const std::string& place);

}  // namespace vernier::internal
