// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/program/limited_grid.h"

#include <fmt/format.h>

#include "calib/base/shown_text.h"
#include "calib/error.h"
#include "cli/program/session.h"

namespace vernier::cli {

std::pair<int, int> parse_limited_grid(const std::string& text,
                                       const std::string& option,
                                       int most_cells) {
  const std::pair<int, int> size = parse_grid(text, option);
  if (size.first * size.second > most_cells) {
    throw Error(option, fmt::format("{}x{} are more than {}", size.first, size.second, most_cells),
                "give a smaller one");
  }
  return size;
}

std::pair<int, int> parse_image_grid(const std::string& text,
                                     const std::string& option,
                                     int most_cells) {
  const std::pair<int, int> size = parse_limited_grid(text, option, most_cells);
  if (size.first < 2 || size.second < 2) {
    throw Error(option, in_quotes(text) + " is smaller than 2x2", "use a grid such as 20x15");
  }
  return size;
}

}  // namespace vernier::cli
