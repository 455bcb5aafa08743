// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "stereo/edges/edge_points_by_row.h"

namespace vernier::stereo::internal {

constexpr int directions = 4;                // per pass; the other pass has the opposite ones
constexpr std::int16_t never_least = 30000;  // stays representable with P1 added

/// Values of the four directions at the points of the last few rows.
class RecentValues {
 public:
  RecentValues(const PointsByRow& points, int disparities) : stride_(disparities + 128) {
    constexpr int rows = 4;  // neighbours are up to three rows away
    int most = 1;
    const auto height = static_cast<int>(points.row_begin.size()) - 1;
    for (int y = 0; y < height; ++y) {
      const auto begin = static_cast<std::size_t>(std::max(0, y - rows + 1));
      most = std::max(most,
                      points.row_begin[static_cast<std::size_t>(y) + 1] - points.row_begin[begin]);
    }
    kept_ = most + 1;
    values_.assign(static_cast<std::size_t>(kept_) * directions * static_cast<std::size_t>(stride_),
                   never_least);
    least_.resize(static_cast<std::size_t>(kept_) * directions);
  }

  std::int16_t* values(int point, int direction) {
    return values_.data() + slot(point, direction) * static_cast<std::size_t>(stride_) + 64;
  }
  std::int16_t& least(int point, int direction) { return least_[slot(point, direction)]; }

 private:
  std::size_t slot(int point, int direction) const {
    return static_cast<std::size_t>((point % kept_) * directions + direction);
  }
  int stride_, kept_ = 0;
  std::vector<std::int16_t> values_, least_;
};

}  // namespace vernier::stereo::internal
