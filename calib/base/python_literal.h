// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

/// The subset of Python's ast.literal_eval that the files of mrcal and NumPy need. Not installed.
namespace vernier::internal {

/// A number, string (or bytes), list (or tuple), dictionary, or the words None, True, False.
struct PythonLiteral {
  enum class Kind { number, text, word, list, dictionary };
  Kind kind = Kind::word;
  double number = 0;
  std::string text;  ///< of a string or word, escapes not decoded
  std::vector<PythonLiteral> items;
  std::vector<std::pair<std::string, PythonLiteral>> entries;  ///< of a dictionary
  int line = 0;

  /// The value of `key`, or null. Repeated keys are rejected when parsing.
  const PythonLiteral* find(std::string_view key) const;
};

/// Parses one literal; comments (#) are allowed anywhere. Throws Error("place:line").
PythonLiteral parse_python_literal(std::string_view text, const std::string& place);

}  // namespace vernier::internal
