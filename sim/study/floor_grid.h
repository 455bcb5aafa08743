// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <vector>

namespace vernier::sim::internal {

/// Points on the floor by square cells. Only cells with points take memory, so that it depends on
/// the number of points and not on their extent.
class FloorGrid {
 public:
  explicit FloorGrid(double cell_m) : cell_m_(cell_m) {}

  /// The coordinates must be below 1e8 cells.
  void add(const Eigen::Vector2d& at_m, int number) {
    cells_[key(column(at_m.x()), column(at_m.y()))].push_back(number);
  }

  /// Calls visit(number) for the points of all cells that a square of ± reach_m touches, until it
  /// returns true; returns whether it did.
  template <class Visit>
  bool any_near(const Eigen::Vector2d& at_m, double reach_m, Visit visit) const {
    const std::int64_t x1 = column(at_m.x() + reach_m), y1 = column(at_m.y() + reach_m);
    for (std::int64_t y = column(at_m.y() - reach_m); y <= y1; ++y) {
      for (std::int64_t x = column(at_m.x() - reach_m); x <= x1; ++x) {
        if (any_in(x, y, visit)) return true;
      }
    }
    return false;
  }

 private:
  std::int64_t column(double coordinate_m) const {
    return static_cast<std::int64_t>(std::floor(coordinate_m / cell_m_));
  }
  static std::uint64_t key(std::int64_t x, std::int64_t y) {
    return (static_cast<std::uint64_t>(x) << 32) ^ (static_cast<std::uint64_t>(y) & 0xffffffffu);
  }
  template <class Visit>
  bool any_in(std::int64_t x, std::int64_t y, Visit& visit) const {
    const auto cell = cells_.find(key(x, y));
    return cell != cells_.end() && std::any_of(cell->second.begin(), cell->second.end(), visit);
  }

  double cell_m_;
  std::unordered_map<std::uint64_t, std::vector<int>> cells_;
};

}  // namespace vernier::sim::internal
