// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/edge_agreement.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "stereo/connected_sets.h"

namespace vernier {
void drop_lonely(const PointsByRow& points,
                 int least_points,
                 int reach,
                 double slope,
                 std::vector<float>& disparity) {
  std::vector<int> matched;  // by row
  std::vector<int> row_begin{0};
  ConnectedSets chains;
  for (int p = 0; p < points.size(); ++p) chains.add();
  const auto height = static_cast<int>(points.row_begin.size()) - 1;
  for (int y = 0; y < height; ++y) {
    std::vector<int> from;  // the first of each row above that is not too far left
    for (int j = std::max(0, y - reach); j < y; ++j) {
      from.push_back(row_begin[static_cast<std::size_t>(j)]);
    }
    const auto row = static_cast<std::size_t>(y);
    for (int p = points.row_begin[row]; p < points.row_begin[row + 1]; ++p) {
      const auto k = static_cast<std::size_t>(p);
      if (std::isnan(disparity[k])) continue;
      const int x = points.x[k];
      const auto join_near = [&](int& begin, int end) {
        while (begin < end &&
               points.x[static_cast<std::size_t>(matched[static_cast<std::size_t>(begin)])] <
                   x - reach) {
          ++begin;
        }
        for (int i = begin; i < end; ++i) {
          const int q = matched[static_cast<std::size_t>(i)];
          if (points.x[static_cast<std::size_t>(q)] > x + reach) break;
          const double most = 1 + slope * std::abs(points.x[static_cast<std::size_t>(q)] - x);
          if (std::abs(disparity[static_cast<std::size_t>(q)] - disparity[k]) <= most) {
            chains.join(p, q);
          }
        }
      };
      for (std::size_t j = 0; j < from.size(); ++j) {
        const auto above = static_cast<std::size_t>(y) - from.size() + j;
        join_near(from[j], row_begin[above + 1]);
      }
      int own = row_begin[row];
      const auto end = static_cast<int>(matched.size());
      own = std::max(own, end - reach);
      join_near(own, end);
      matched.push_back(p);
    }
    row_begin.push_back(static_cast<int>(matched.size()));
  }
  std::vector<int> size(points.x.size(), 0);
  for (const int p : matched) ++size[static_cast<std::size_t>(chains.root(p))];
  for (const int p : matched) {
    if (size[static_cast<std::size_t>(chains.root(p))] >= least_points) continue;
    disparity[static_cast<std::size_t>(p)] = std::numeric_limits<float>::quiet_NaN();
  }
}

}  // namespace vernier
