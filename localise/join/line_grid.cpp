// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/join/line_grid.h"

#include <algorithm>
#include <array>

namespace vernier::localise::internal {

std::vector<std::uint64_t> LineGrid::passed(const Eigen::Vector3d& a_m,
                                            const Eigen::Vector3d& b_m,
                                            int reach) const {
  constexpr std::int64_t offset = 1 << 20, most = (1 << 21) - 1;
  // samples half a cell apart leave out corners that it only grazes; the reach covers these
  const int steps = static_cast<int>(std::ceil(2 * (b_m - a_m).norm() / cell_m_));
  std::vector<std::uint64_t> keys;
  for (int i = 0; i <= steps; ++i) {
    const double t = steps > 0 ? static_cast<double>(i) / steps : 0;
    const Eigen::Vector3d p = (a_m + t * (b_m - a_m)) / cell_m_;
    std::array<std::int64_t, 3> cell{};
    for (int k = 0; k < 3; ++k) cell[k] = static_cast<std::int64_t>(std::floor(p[k])) + offset;
    for (std::int64_t x = cell[0] - reach; x <= cell[0] + reach; ++x) {
      for (std::int64_t y = cell[1] - reach; y <= cell[1] + reach; ++y) {
        for (std::int64_t z = cell[2] - reach; z <= cell[2] + reach; ++z) {
          keys.push_back(
              static_cast<std::uint64_t>((x & most) << 42 | (y & most) << 21 | (z & most)));
        }
      }
    }
  }
  std::sort(keys.begin(), keys.end());
  keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
  return keys;
}

std::vector<int> LineGrid::near(const Eigen::Vector3d& a_m, const Eigen::Vector3d& b_m) {
  std::vector<int> found;
  ++query_;
  for (const std::uint64_t key : passed(a_m, b_m, 1)) {
    const auto cell = cells_.find(key);
    if (cell == cells_.end()) continue;
    for (const int number : cell->second) {
      if (last_query_[number] == query_) continue;
      last_query_[number] = query_;
      found.push_back(number);
    }
  }
  return found;
}

}  // namespace vernier::localise::internal
