// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/board/nearest_corners.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "calib/board_observations.h"

namespace vernier::internal {

std::vector<std::size_t> nearest_corners(const std::vector<Eigen::Vector3d>& target_m,
                                         const BoardView& view,
                                         std::size_t i,
                                         std::size_t count,
                                         const std::vector<bool>& out) {
  std::vector<std::pair<double, std::size_t>> order;
  for (std::size_t k = 0; k < view.ids.size(); ++k) {
    if (k == i || (!out.empty() && out[k])) continue;
    order.emplace_back((target_m[view.ids[k]] - target_m[view.ids[i]]).squaredNorm(), k);
  }
  const auto n = static_cast<std::ptrdiff_t>(std::min(count, order.size()));
  std::partial_sort(order.begin(), order.begin() + n, order.end());
  std::vector<std::size_t> nearest;
  for (std::ptrdiff_t k = 0; k < n; ++k) nearest.push_back(order[k].second);
  return nearest;
}

}  // namespace vernier::internal
