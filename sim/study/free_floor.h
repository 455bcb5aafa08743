// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <unordered_set>
#include <utility>
#include <vector>

#include "calib/statistics/random.h"
#include "sim/visibility.h"
#include "sim/visibility/box_tree.h"
#include "sim/world.h"

namespace vernier::sim::internal {

/// Where a robot can stand in a world, whether it can get there or not. Immutable.
class Standing {
 public:
  /// Keeps a reference to `world`.
  Standing(const World& world, double eye_height_m);

  /// Whether a point is in the box of standing_box().
  bool in_box(const Eigen::Vector2d& at_m) const {
    return (at_m.array() >= low_m.array()).all() && (at_m.array() <= high_m.array()).all();
  }

  /// Same as is_free() for the robot's radius and height, in about the logarithm of the surfaces.
  bool is_free(const Eigen::Vector2d& at_m) const;

  Eigen::Vector2d low_m, high_m;  ///< of the box

 private:
  const World& world_;
  double top_m_;
  BoxTree surfaces_;
};

/// Where a robot can stand and get to from the route. Immutable.
///
/// From the route a search spreads over a lattice of 0.15 m, from node to node, as long as the
/// robot can stand at each (is_free) and no surface separates them at the camera's height. A place
/// is reached if the robot can stand there and a reached node of the 3 x 3 around it is in sight.
class FreeFloor {
 public:
  /// Keeps a reference to `visibility`.
  FreeFloor(const Visibility& visibility, double eye_height_m);

  /// Whether the robot can get there. Where the search would not end (is_bounded), whether it can
  /// stand there.
  bool reaches(const Eigen::Vector2d& at_m) const;

  /// False if the floor is larger than 22,500 m².
  bool is_bounded() const { return bounded_; }

  /// Uniform over the places that are reached. Throws Error if it is not bounded, or none is found
  /// in 1000 draws.
  Eigen::Vector2d draw(vernier::internal::RandomStream& draws) const;

 private:
  using Node = std::pair<int, int>;
  static std::uint64_t key(const Node& node) {
    return static_cast<std::uint64_t>(static_cast<std::uint32_t>(node.first)) << 32 |
           static_cast<std::uint32_t>(node.second);
  }
  Eigen::Vector2d at(const Node& node) const;
  Node nearest(const Eigen::Vector2d& at_m) const;
  bool sees(const Eigen::Vector2d& from_m, const Eigen::Vector2d& to_m) const;
  void spread();

  const Visibility& visibility_;
  double height_m_;
  Standing standing_;
  bool bounded_ = true;
  std::unordered_set<std::uint64_t> reached_;
  std::vector<Node> cells_;  // squares around the nodes and their neighbours, ascending
};

}  // namespace vernier::sim::internal
