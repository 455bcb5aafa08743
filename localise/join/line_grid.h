// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <unordered_map>
#include <vector>

namespace vernier::localise::internal {

/// Segments by the cubic cells that they pass, to find those near another segment: within a cell's
/// side of it for certain, and no farther than about two. Coordinates must be below 1e6 cells.
class LineGrid {
 public:
  explicit LineGrid(double cell_m) : cell_m_(cell_m) {}

  void add(const Eigen::Vector3d& a_m, const Eigen::Vector3d& b_m, int number) {
    if (number >= static_cast<int>(last_query_.size())) last_query_.resize(number + 1, 0);
    for (const std::uint64_t key : passed(a_m, b_m, 0)) {
      std::vector<int>& cell = cells_[key];
      if (cell.empty() || cell.back() != number) cell.push_back(number);
    }
  }

  /// Numbers near a segment, each once, in an order of its own that is always the same.
  std::vector<int> near(const Eigen::Vector3d& a_m, const Eigen::Vector3d& b_m);

 private:
  /// Keys of the cells within `reach` cells of those that it passes, ascending.
  std::vector<std::uint64_t> passed(const Eigen::Vector3d& a_m,
                                    const Eigen::Vector3d& b_m,
                                    int reach) const;

  double cell_m_;
  std::unordered_map<std::uint64_t, std::vector<int>> cells_;
  std::vector<int> last_query_;  // by number: when it was found last
  int query_ = 0;
};

}  // namespace vernier::localise::internal
