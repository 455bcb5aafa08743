// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/edges/edge_points_by_row.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace vernier::stereo::internal {
namespace {

/// For the points of row `from` in turn, the nearest point of another row.
class RowScan {
 public:
  RowScan(const PointsByRow& points, int row) : x_(points.x.data()) {
    const int rows = static_cast<int>(points.row_begin.size()) - 1;
    if (row < 0 || row >= rows) return;
    begin_ = at_ = points.row_begin[static_cast<std::size_t>(row)];
    end_ = points.row_begin[static_cast<std::size_t>(row) + 1];
  }

  /// Within `reach` pixels of x, the right one if tied; −1: none. x must not decrease between
  /// calls.
  int nearest(int x, int reach) {
    while (at_ < end_ && x_[at_] < x) ++at_;
    const int after = at_ < end_ ? x_[at_] - x : reach + 1;
    const int before = at_ > begin_ ? x - x_[at_ - 1] : reach + 1;
    if (std::min(after, before) > reach) return -1;
    return after <= before ? at_ : at_ - 1;
  }

 private:
  const int* x_;
  int begin_ = 0, end_ = 0, at_ = 0;
};

/// The neighbours above (step −1) or below (+1) of a row's points: straight, bridging gaps of up to
/// two rows, and diagonal.
void find_across(PointsByRow& points, int row, int step) {
  RowScan next(points, row + step), second(points, row + 2 * step), third(points, row + 3 * step),
      left(points, row + step), right(points, row + step);
  const std::size_t straight = step < 0 ? 1 : 5, to_left = step < 0 ? 2 : 7,
                    to_right = step < 0 ? 3 : 6;
  for (int i = points.row_begin[static_cast<std::size_t>(row)];
       i < points.row_begin[static_cast<std::size_t>(row) + 1]; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const int x = points.x[k];
    int found = next.nearest(x, 2);
    if (found < 0) found = second.nearest(x, 3);
    if (found < 0) found = third.nearest(x, 3);
    points.neighbours[k][straight] = found;
    points.neighbours[k][to_left] = left.nearest(x - 2, 2);
    points.neighbours[k][to_right] = right.nearest(x + 2, 2);
  }
}

}  // namespace

double PointsByRow::distance_px(int a, int b) const {
  const auto i = static_cast<std::size_t>(a), j = static_cast<std::size_t>(b);
  const double dx = x[i] - x[j], dy = y[i] - y[j];
  return std::sqrt(dx * dx + dy * dy);
}

PointsByRow points_by_row(std::vector<int> x, std::vector<int> y, int height_px) {
  PointsByRow points{std::move(x), std::move(y), {}, {}};
  points.row_begin.assign(static_cast<std::size_t>(height_px) + 1, 0);
  for (const int row : points.y) ++points.row_begin[static_cast<std::size_t>(row) + 1];
  for (std::size_t row = 1; row < points.row_begin.size(); ++row) {
    points.row_begin[row] += points.row_begin[row - 1];
  }
  points.neighbours.resize(points.x.size());
  for (int row = 0; row < height_px; ++row) {
    const int begin = points.row_begin[static_cast<std::size_t>(row)],
              end = points.row_begin[static_cast<std::size_t>(row) + 1];
    for (int i = begin; i < end; ++i) {
      points.neighbours[static_cast<std::size_t>(i)][0] = i > begin ? i - 1 : -1;
      points.neighbours[static_cast<std::size_t>(i)][4] = i + 1 < end ? i + 1 : -1;
    }
    find_across(points, row, -1);
    find_across(points, row, 1);
  }
  return points;
}

}  // namespace vernier::stereo::internal
