// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <vector>

#include "sim/study/floor_grid.h"
#include "sim/study/floor_rows.h"
#include "sim/world.h"

namespace vernier::sim::internal {

/// A vertical edge: its position on the floor and its range of heights.
struct Upright {
  Eigen::Vector2d at_m;
  double low_m, high_m;
};

/// Whether a segment is vertical.
bool is_upright(const Eigen::Vector3d& a_m, const Eigen::Vector3d& b_m);

/// The vertical edges of a world, by range of heights (to 1 mm) and by place.
class UprightEdges {
 public:
  /// By how much positions and heights may differ, metres.
  static constexpr double tolerance_m = 0.02;

  explicit UprightEdges(const World& world);

  /// Edges of which something may be a visible part, as ranges of numbers.
  struct Matches {
    struct Range {
      int first, last;  ///< one beyond the last
    };
    std::vector<Range> ranges;
    int count = 0;
  };
  Matches matches(const Upright& part) const;

  /// How many edges `matches` gives.
  int count_around(const Upright& part) const;

  /// Whether there is such an edge at the place of `part`.
  bool has(const Upright& part) const;

  template <class Visit>
  void visit_all(const Matches& of, Visit visit) const {
    for (const Matches::Range& range : of.ranges) {
      for (int i = range.first; i < range.last; ++i) visit(uprights_[i]);
    }
  }

  /// Calls visit(upright) for those matches of `part` that are at a distance from a point, to
  /// `slack_m`.
  template <class Visit>
  void visit_at_distance(const Upright& part,
                         const Matches& of,
                         const Eigen::Vector2d& from_m,
                         double distance_m,
                         double slack_m,
                         Visit visit) const {
    const double inner = std::max(0.0, distance_m - slack_m), outer = distance_m + slack_m;
    const double least2 = inner * inner, most2 = outer * outer;
    if (of.count <= ring_cost(distance_m)) {
      visit_all(of, [&](const Upright& upright) {
        const double d2 = (upright.at_m - from_m).squaredNorm();
        if (d2 >= least2 && d2 <= most2) visit(upright);
      });
      return;
    }
    rows_.visit_ring(from_m, inner, outer, [&](int i) {
      if (may_hold(uprights_[i], part)) visit(uprights_[i]);
    });
  }

  /// What finding the edges at a distance costs: in edges tried one by one.
  double ring_cost(double distance_m) const {
    return 10 + 30 * distance_m / row_m_;  // two searches in each row
  }

 private:
  struct HeightClass {
    double low_m, high_m;
    int first, last;
  };
  template <class Heights>
  static bool may_hold(const Heights& all, const Upright& part) {
    return all.low_m < part.low_m + tolerance_m && all.high_m > part.high_m - tolerance_m;
  }

  std::vector<Upright> uprights_;  // class by class
  std::vector<HeightClass> classes_;
  double row_m_ = 1;
  FloorGrid close_{0.1};
  FloorRows rows_;
};

}  // namespace vernier::sim::internal
