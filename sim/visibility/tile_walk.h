// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "sim/visibility/shadow.h"

namespace vernier::sim::internal {

/// Index of the tile of `count` that contains coordinate g, in tiles.
inline int clamp_tile(double g, int count) {
  return static_cast<int>(std::clamp(g, 0.0, count - 1.0));
}

/// Traverses the tiles under a segment's projection, in slabs across the axis along which it
/// crosses more tiles. With s the fraction of the projection, 1 / depth is linear in s, as is
/// position.
class TileWalk {
 public:
  TileWalk(const ProjectedSegment& picture,
           const Eigen::Vector2d& origin,
           const Eigen::Vector2d& tiles_per_unit,
           const Eigen::Vector2i& tile_count)
      : g0_((picture.x0 - origin).cwiseProduct(tiles_per_unit)),
        dg_((picture.x1 - picture.x0).cwiseProduct(tiles_per_unit)),
        inverse_z0_(1 / picture.z0),
        inverse_dz_(1 / picture.z1 - 1 / picture.z0),
        major_(std::abs(dg_[1]) > std::abs(dg_[0])),
        columns_(tile_count[0]),
        minor_count_(tile_count[1 - major_]),
        direction_(dg_[major_] < 0 ? -1 : 1) {
    const double slack = direction_ * slack_tiles;
    slab_ = clamp_tile(g0_[major_] - slack, tile_count[major_]);
    last_ = clamp_tile(g0_[major_] + dg_[major_] + slack, tile_count[major_]);
    enter_slab();
  }

  bool at_last() const { return slab_ == last_; }

  /// Advances to the next slab; false after the last.
  bool next() {
    if (at_last()) return false;
    slab_ += direction_;
    s0_ = is_point() ? 0 : s1_;
    enter_slab();
    return true;
  }

  /// The part of the projection in this slab, and the tiles under it: first_minor to last_minor,
  /// including tiles that it only touches.
  double s0() const { return s0_; }
  double s1() const { return s1_; }
  int first_minor() const { return minor0_; }
  int last_minor() const { return minor1_; }
  int tile(int minor) const { return major_ ? slab_ * columns_ + minor : minor * columns_ + slab_; }

  /// 1 / depth of that part's nearest and farthest point.
  double inverse_nearest() const {
    return inverse_z0_ + (inverse_dz_ > 0 ? s1_ : s0_) * inverse_dz_;
  }
  double inverse_farthest() const {
    return inverse_z0_ + (inverse_dz_ > 0 ? s0_ : s1_) * inverse_dz_;
  }

 private:
  static constexpr double slack_tiles = 1e-7;

  /// A segment seen end-on does not cross any slab.
  bool is_point() const { return std::abs(dg_[major_]) < 1e-12; }

  void enter_slab() {
    const double exit = slab_ + (direction_ > 0 ? 1 : 0);
    s1_ = at_last() || is_point() ? 1 : std::clamp((exit - g0_[major_]) / dg_[major_], s0_, 1.0);
    const double m0 = g0_[1 - major_] + s0_ * dg_[1 - major_];
    const double m1 = g0_[1 - major_] + s1_ * dg_[1 - major_];
    minor0_ = clamp_tile(std::min(m0, m1) - slack_tiles, minor_count_);
    minor1_ = clamp_tile(std::max(m0, m1) + slack_tiles, minor_count_);
  }

  Eigen::Vector2d g0_, dg_;  ///< the projection in tiles: g0 + s dg
  double inverse_z0_, inverse_dz_;
  int major_, columns_, minor_count_, direction_;
  int slab_ = 0, last_ = 0;
  double s0_ = 0, s1_ = 1;
  int minor0_ = 0, minor1_ = 0;
};

}  // namespace vernier::sim::internal
