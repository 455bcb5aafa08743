// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "calib/statistics/draw_sources.h"
#include "calib/statistics/random.h"
#include "sim/buildings/wire_shapes.h"
#include "sim/world.h"

namespace vernier::sim::internal {

/// The stream of all draws of a generated building.
inline constexpr auto building_draws =
    static_cast<std::uint32_t>(vernier::internal::DrawSource::office);

/// One wall of a room seen from inside: x along it, y into the room, z up.
struct RoomWall {
  QuarterFrame frame;
  double length_m = 0;
};

/// A rectangle of floor with its four walls: 0 at low y, 1 at high x, 2 at high y, 3 at low x.
struct RectangularRoom {
  std::uint32_t number = 0;  ///< key of its draws
  Eigen::Vector3d low_m, high_m;

  RoomWall wall(int side) const;
};

/// A path on the floor that furniture keeps clear of.
using FloorPath = std::vector<Eigen::Vector2d>;

/// Shortest horizontal distance from a polyline on the floor to an upright box.
double distance_to_path(const Eigen::AlignedBox3d& box, const FloorPath& path_m);

/// Assembles a building: places templates and loose objects in the current room, and keeps them
/// apart from each other and from the route.
class BuildingSite {
 public:
  explicit BuildingSite(std::uint64_t seed);

  /// Begins a room; objects placed in it stay clear of `path_m`.
  void enter(const RectangularRoom& room, const FloorPath& path_m);

  /// Begins a room that is the union of `parts`; an object lies in one of them.
  void enter(std::uint32_t number,
             const std::vector<Eigen::AlignedBox3d>& parts,
             const std::vector<FloorPath>& paths_m);

  /// A template that the site shall know, from now on.
  void define(const WorldTemplate& entry);

  /// Random stream of one item of the current room.
  vernier::internal::RandomStream draws(std::uint32_t item) const;

  /// Whether a box of the current room is free. Objects above head height may overlap the route.
  bool is_free(const Eigen::AlignedBox3d& box) const;
  void occupy(const Eigen::AlignedBox3d& box) { occupied_.push_back(box); }

  /// The box occupied by a template at `at_m` in a frame, from the wall on.
  Eigen::AlignedBox3d taken(const std::string& name,
                            const QuarterFrame& frame,
                            const Eigen::Vector3d& at_m) const;

  /// Places a template if the space is free; `yaw_deg` rotates it about its origin.
  bool try_place(const std::string& name, const QuarterFrame& frame, const Eigen::Vector3d& at_m);
  void place(const std::string& name,
             const QuarterFrame& frame,
             const Eigen::Vector3d& at_m,
             int yaw_deg = 0);

  /// Adds a loose box, and a line along its lid and down its front, as on a carton.
  bool try_carton(const QuarterFrame& frame, const Eigen::AlignedBox3d& box);

  WorldDescription& world() { return world_; }
  Shapes& loose() { return loose_; }
  const RectangularRoom& room() const { return room_; }

  /// The description with all loose features, without templates that were never placed.
  WorldDescription finish();

 private:
  std::uint64_t seed_;
  WorldDescription world_;
  std::map<std::string, Eigen::AlignedBox3d> bounds_;
  Shapes loose_;
  RectangularRoom room_;
  std::vector<Eigen::AlignedBox3d> parts_;  ///< of the current room, a hair larger
  std::vector<FloorPath> paths_m_;
  std::vector<Eigen::AlignedBox3d> occupied_;
};

}  // namespace vernier::sim::internal
