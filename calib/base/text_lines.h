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

/// Lines of a text file with their numbers, for messages.
class TextLines {
 public:
  /// Throws Error if the file cannot be read.
  explicit TextLines(const std::filesystem::path& file, std::size_t longest_line = 20'000);

  /// The next line without its end (LF or CRLF); false at the end of the file. Throws Error if it
  /// is longer than `longest_line` bytes.
  bool next(std::string_view& line);

  /// Bytes of the whole file.
  std::size_t size() const { return text_.size(); }

  /// Location of the last line returned, such as "pairs.csv:37".
  std::string place() const;

 private:
  std::filesystem::path file_;
  std::string text_;
  std::size_t longest_line_;
  std::size_t begin_ = 0;
  std::size_t number_ = 0;
};

/// Whether a byte is an ASCII digit, in every locale.
inline bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// Fields of a line between separators. If the separators include a blank, repeated ones count as
/// one.
std::vector<std::string_view> split_fields(std::string_view line, std::string_view separators);

/// The number that all of `text` represents, or std::nullopt. The decimal separator is a point in
/// every locale. Infinities and "nan" are accepted, a leading sign too, a leading blank not. A
/// value too small for a double is 0; one too large, or of more than 1,000 bytes, is not accepted.
std::optional<double> to_real(std::string_view text);

/// The same, but for infinities and "nan".
std::optional<double> to_finite(std::string_view text);

/// Parses a number. Throws Error(`place`), naming `what`, if `field` is not one.
double parse_real(std::string_view field, const std::string& place, std::string_view what);
int parse_whole(std::string_view field, const std::string& place, std::string_view what);

}  // namespace vernier::internal
