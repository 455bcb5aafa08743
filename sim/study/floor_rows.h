// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

namespace vernier::sim::internal {

/// Points on the floor in rows of a given height, each row by x: for rings, which are thin. Memory
/// depends on the number of points and not on their extent. Immutable.
class FloorRows {
 public:
  FloorRows() = default;

  /// The coordinates must be below 1e8 rows.
  FloorRows(const std::vector<Eigen::Vector2d>& points_m, double row_m)
      : row_m_(row_m), number_(points_m.size()) {
    std::iota(number_.begin(), number_.end(), 0);
    std::sort(number_.begin(), number_.end(), [&](int i, int j) {
      const std::int64_t a = row(points_m[i].y()), b = row(points_m[j].y());
      if (a != b) return a < b;
      return points_m[i].x() != points_m[j].x() ? points_m[i].x() < points_m[j].x() : i < j;
    });
    for (std::size_t k = 0; k < number_.size(); ++k) {
      const Eigen::Vector2d& p = points_m[number_[k]];
      if (rows_.empty() || rows_.back().row != row(p.y())) rows_.push_back({row(p.y()), k});
      at_m_.push_back(p);
    }
  }

  /// Calls visit(number) for the points at `inner_m` to `outer_m` from a point, in an order that
  /// depends on the points only.
  template <class Visit>
  void visit_ring(const Eigen::Vector2d& at_m, double inner_m, double outer_m, Visit visit) const {
    const double inner2 = inner_m > 0 ? inner_m * inner_m : 0, outer2 = outer_m * outer_m;
    const auto scan = [&](std::size_t first, std::size_t last, double x0, double x1) {
      const auto before = [](const Eigen::Vector2d& p, double x) { return p.x() < x; };
      const auto end = at_m_.begin() + static_cast<std::ptrdiff_t>(last);
      auto p =
          std::lower_bound(at_m_.begin() + static_cast<std::ptrdiff_t>(first), end, x0, before);
      for (; p != end && p->x() <= x1; ++p) {
        const double d2 = (*p - at_m).squaredNorm();
        if (d2 >= inner2 && d2 <= outer2)
          visit(number_[static_cast<std::size_t>(p - at_m_.begin())]);
      }
    };
    constexpr double slack = 1e-9;  // of rounding, relative and metres; the ring itself is exact
    const std::int64_t last = row(at_m.y() + outer_m);
    auto r = std::lower_bound(rows_.begin(), rows_.end(), row(at_m.y() - outer_m),
                              [](const Row& a, std::int64_t b) { return a.row < b; });
    for (; r != rows_.end() && r->row <= last; ++r) {
      const double low = row_m_ * static_cast<double>(r->row) - at_m.y(), high = low + row_m_;
      const double nearest = std::max({low, -high, 0.0}), farthest = std::max(-low, high);
      const double wide =
          std::sqrt(std::max(0.0, outer2 - nearest * nearest)) * (1 + slack) + slack;
      const double hole =
          std::sqrt(std::max(0.0, inner2 - farthest * farthest)) * (1 - slack) - slack;
      const std::size_t first = r->first;
      const std::size_t end = r + 1 == rows_.end() ? at_m_.size() : (r + 1)->first;
      if (hole > 0) {
        scan(first, end, at_m.x() - wide, at_m.x() - hole);
        scan(first, end, at_m.x() + hole, at_m.x() + wide);
      } else {
        scan(first, end, at_m.x() - wide, at_m.x() + wide);
      }
    }
  }

 private:
  struct Row {
    std::int64_t row;
    std::size_t first;
  };
  std::int64_t row(double y_m) const { return static_cast<std::int64_t>(std::floor(y_m / row_m_)); }

  double row_m_ = 1;
  std::vector<int> number_;
  std::vector<Eigen::Vector2d> at_m_;  // by row, then by x
  std::vector<Row> rows_;
};

}  // namespace vernier::sim::internal
