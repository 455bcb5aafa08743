// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
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
  struct Entry;                ///< a pair would need the whole type here
  std::vector<Entry> entries;  ///< of a dictionary
  int line = 0;

  /// The value of `key`, or null. Repeated keys are rejected when parsing.
  const PythonLiteral* find(std::string_view key) const;
};

struct PythonLiteral::Entry {
  std::string key;
  PythonLiteral value;
};

/// Parses one literal; comments (#) are allowed anywhere. Throws Error("place:line") if it is
/// malformed, nested more than 32 levels deep, longer than 64 MB or of more than 100,000 values,
/// has a key twice, or a number that no double can hold.
PythonLiteral parse_python_literal(std::string_view text, const std::string& place);

}  // namespace vernier::internal
