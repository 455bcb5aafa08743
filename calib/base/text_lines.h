// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace vernier::internal {

/// Lines of a text file with the number of each, for messages.
class TextLines {
 public:
  /// Throws Error where the file cannot be read.
  explicit TextLines(const std::filesystem::path& file);

  /// The next line without its end (LF or CRLF); false at the end of the file.
  bool next(std::string_view& line);

  /// Bytes of the whole file.
  std::size_t size() const { return text_.size(); }

  /// "pairs.csv:37", the line last given out.
  std::string place() const;

 private:
  std::filesystem::path file_;
  std::string text_;
  std::size_t begin_ = 0;
  std::size_t number_ = 0;
};

/// Fields of a line between separators; with a blank among these, repeated ones count once.
std::vector<std::string_view> split_fields(std::string_view line, std::string_view separators);

/// The number that all of `text` is, or nothing: the decimal point is a point whatever the locale
/// says. Infinities and "nan" are numbers; a sign may lead, a blank may not. What is too small for
/// a double is 0, what is too large is no number.
std::optional<double> to_real(std::string_view text);

/// Throws Error(`place`) where `field` is no number, naming `what` it should have been.
double parse_real(std::string_view field, const std::string& place, std::string_view what);
int parse_whole(std::string_view field, const std::string& place, std::string_view what);

}  // namespace vernier::internal
