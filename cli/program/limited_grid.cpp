// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/program/limited_grid.h"

#include <fmt/format.h>

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

}  // namespace vernier::cli
