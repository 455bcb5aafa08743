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
#include "sim/world.h"
#include "sim/world/office_shapes.h"

namespace vernier::sim::internal {

/// The stream of all draws of a generated office.
inline constexpr auto office_draws =
    static_cast<std::uint32_t>(vernier::internal::DrawSource::office);

/// One wall of a room seen from inside: x along it, y into the room, z up.
struct OfficeWall {
  QuarterFrame frame;
  double length_m = 0;
};

/// A rectangle of floor with its four walls: 0 at low y, 1 at high x, 2 at high y, 3 at low x.
struct OfficeRoom {
  std::uint32_t number = 0;  ///< key of its draws
  Eigen::Vector3d low_m, high_m;

  OfficeWall wall(int side) const;
};

/// Shortest horizontal distance from a polyline on the floor to an upright box.
double distance_to_path(const Eigen::AlignedBox3d& box, const std::vector<Eigen::Vector2d>& path_m);

/// Assembles an office: places templates and loose objects in the current room, and keeps them
/// apart from each other and from the route.
class OfficeSite {
 public:
  explicit OfficeSite(std::uint64_t seed);

  /// Begins a room; objects placed in it stay clear of `path_m`.
  void enter(const OfficeRoom& room, const std::vector<Eigen::Vector2d>& path_m);

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
  const OfficeRoom& room() const { return room_; }

  /// The description with all loose features, without templates that were never placed.
  WorldDescription finish();

 private:
  std::uint64_t seed_;
  WorldDescription world_;
  std::map<std::string, Eigen::AlignedBox3d> bounds_;
  Shapes loose_;
  OfficeRoom room_;
  std::vector<Eigen::Vector2d> path_m_;
  std::vector<Eigen::AlignedBox3d> occupied_;
};

}  // namespace vernier::sim::internal
