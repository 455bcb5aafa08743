// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstdint>
#include <unordered_map>
#include <vector>

namespace vernier::sim::internal {

/// Points in space by cubic cells. Coordinates must be below 1e6 cells.
class PointGrid {
 public:
  explicit PointGrid(double cell) : cell_(cell) {}

  void add(const Eigen::Vector3d& at, std::uint32_t number) {
    cells_[key(cell_of(at))].push_back(number);
  }

  /// Calls visit(number) for the points of the cell and its 26 neighbours.
  template <class Visit>
  void visit_near(const Eigen::Vector3d& at, Visit visit) const {
    const Cell c = cell_of(at);
    for (std::int64_t x = c[0] - 1; x <= c[0] + 1; ++x) {
      for (std::int64_t y = c[1] - 1; y <= c[1] + 1; ++y) {
        for (std::int64_t z = c[2] - 1; z <= c[2] + 1; ++z) {
          const auto found = cells_.find(key({x, y, z}));
          if (found == cells_.end()) continue;
          for (const std::uint32_t number : found->second) visit(number);
        }
      }
    }
  }

 private:
  using Cell = std::array<std::int64_t, 3>;
  Cell cell_of(const Eigen::Vector3d& at) const {
    return {static_cast<std::int64_t>(std::floor(at.x() / cell_)),
            static_cast<std::int64_t>(std::floor(at.y() / cell_)),
            static_cast<std::int64_t>(std::floor(at.z() / cell_))};
  }
  static std::uint64_t key(const Cell& cell) {
    constexpr std::int64_t offset = 1 << 20, most = (1 << 21) - 1;
    std::uint64_t key = 0;
    for (const std::int64_t c : cell)
      key = key << 21 | static_cast<std::uint64_t>((c + offset) & most);
    return key;
  }

  double cell_;
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> cells_;
};

}  // namespace vernier::sim::internal
