// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <charconv>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "calib/board_observations.h"
#include "calib/error.h"

/// Internal to calib/: what the readers of files with a corner a line share. Not installed.
namespace vernier::corner_lines {

/// Lines of a text file with the number of each, for messages.
class Lines {
 public:
  explicit Lines(const std::filesystem::path& file);

  bool next(std::string_view& line);
  std::string place() const { return file_.string() + ":" + std::to_string(number_); }

 private:
  std::filesystem::path file_;
  std::string text_;
  std::size_t begin_ = 0;
  int number_ = 0;
};

/// Fields between separators; runs of blanks are one separator.
std::vector<std::string_view> split(std::string_view line, std::string_view separators);

template <class Number>
Number parse_number(std::string_view field, const std::string& place, std::string_view what) {
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

/// Throws Error for a pixel that is not finite or, where their size is known, outside its camera's
/// images; one size stands for all. `corner` names it in a person's words.
void check_pixel(const Eigen::Vector2d& pixel_px,
                 std::size_t camera,
                 const std::vector<Eigen::Vector2i>& size_px,
                 const std::string& place,
                 const std::string& corner);

/// Gives all cameras their size where one stands for them, then check_and_sort; what that says
/// begins with the file.
BoardObservations finished(BoardObservations observations,
                           std::size_t cameras,
                           const std::filesystem::path& file);

}  // namespace vernier::corner_lines
