// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "sim/study/floor_grid.h"
#include "sim/world.h"

namespace vernier::sim::internal {

/// A vertical edge: its position on the floor and its range of heights.
struct Upright {
  Eigen::Vector2d at_m;
  double low_m, high_m;
};

/// Whether a segment is vertical.
bool is_upright(const Eigen::Vector3d& a_m, const Eigen::Vector3d& b_m);

/// The vertical edges of a world, in classes of the same range of heights (to 1 mm), each by place.
class UprightEdges {
 public:
  /// By how much positions and heights may differ, metres.
  static constexpr double tolerance_m = 0.02;

  explicit UprightEdges(const World& world);

  /// Number of edges of which `part` may be a visible part.
  int count_around(const Upright& part) const;

  /// Whether there is such an edge at the place of `part`.
  bool has(const Upright& part) const;

  /// Calls visit(upright) for the edges of which `part` may be a visible part.
  template <class Visit>
  void visit_all(const Upright& part, Visit visit) const {
    for (const HeightClass& all : classes_) {
      if (!all.may_hold(part)) continue;
      for (const Upright& upright : all.uprights) visit(upright);
    }
  }

  /// The same for edges at a distance from a point, to `slack_m`.
  template <class Visit>
  void visit_at_distance(const Upright& part,
                         const Eigen::Vector2d& from_m,
                         double distance_m,
                         double slack_m,
                         Visit visit) const {
    constexpr int few = 64;  // as quickly tried one by one
    const auto try_one = [&](const Upright& upright) {
      if (std::abs((upright.at_m - from_m).norm() - distance_m) <= slack_m) visit(upright);
    };
    std::vector<int> in_ring;
    for (const HeightClass& all : classes_) {
      if (!all.may_hold(part)) continue;
      if (all.uprights.size() <= few) {
        for (const Upright& upright : all.uprights) try_one(upright);
        continue;
      }
      all.wide.find_in_ring(from_m, distance_m - 2 * slack_m, distance_m + 2 * slack_m, in_ring);
      for (const int i : in_ring) try_one(all.uprights[i]);
    }
  }

 private:
  struct HeightClass {
    double low_m, high_m;
    std::vector<Upright> uprights;
    FloorGrid close{0.1}, wide{1};  // numbers of uprights, for two ranges of distance

    bool may_hold(const Upright& part) const {
      return low_m < part.low_m + tolerance_m && high_m > part.high_m - tolerance_m;
    }
  };
  std::vector<HeightClass> classes_;
};

}  // namespace vernier::sim::internal
