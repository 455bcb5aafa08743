// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/matching/side_levels.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "stereo/grey_levels.h"

namespace vernier::stereo::internal {

LevelImage mean_levels(const GreyLevels& image, int border) {
  LevelImage levels{image.width_px, image.height_px, border, {}};
  const int width = image.width_px, last_row = image.height_px - 1;
  levels.values.resize(levels.stride() * static_cast<std::size_t>(image.height_px));
  std::vector<float> column(static_cast<std::size_t>(width) + 2);  // sums of three rows
  for (int y = 0; y <= last_row; ++y) {
    for (int x = 0; x < width; ++x) {
      column[static_cast<std::size_t>(x) + 1] =
          image(x, std::max(y - 1, 0)) + image(x, y) + image(x, std::min(y + 1, last_row));
    }
    column.front() = column[1];
    column.back() = column[static_cast<std::size_t>(width)];
    std::uint8_t* const row = levels.row(y);
    for (int x = 0; x < width; ++x) {
      const float* const sums = column.data() + x;
      const float mean = (sums[0] + sums[1] + sums[2]) / 9;
      row[x] = static_cast<std::uint8_t>(std::clamp(mean + 0.5f, 0.0f, 255.0f));
    }
    std::fill(row - border, row, row[0]);
    std::fill(row + width, row + width + border, row[width - 1]);
  }
  return levels;
}

LevelImage mirrored(const LevelImage& levels) {
  LevelImage other = levels;
  for (int y = 0; y < levels.height; ++y) {
    std::reverse(other.row(y) - levels.border, other.row(y) + levels.width + levels.border);
  }
  return other;
}

SideOffset side_offset(const Eigen::Vector2f& normal) {
  constexpr float beyond_the_blur_px = 2;
  const auto step = [](float n) {
    if (std::isnan(n)) return 0;
    return static_cast<int>(std::lround(beyond_the_blur_px * std::clamp(n, -1.0f, 1.0f)));
  };
  return {step(normal.x()), step(normal.y())};
}

}  // namespace vernier::stereo::internal
