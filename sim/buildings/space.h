// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <vector>

#include "sim/buildings/building_site.h"
#include "sim/buildings/office_furniture.h"
#include "sim/buildings/wire_shapes.h"

namespace vernier::sim::internal {

inline constexpr double skirting_m = 0.08;  ///< height of the boards along the walls

/// Ends along x at which a doorway, in the middle of the width, leads on to the next part of a
/// building.
struct OpenEnds {
  bool low_x = false, high_x = false;
};

/// The walls of a floor that is the union of rectangles, one for each straight stretch. Seen from
/// above they run counter-clockwise around the floor, so each begins where another ends; around
/// what the floor encloses they run the other way.
std::vector<RoomWall> walls_around(const std::vector<Eigen::AlignedBox2d>& floor_m);

/// A doorway or passage in a wall, given by its index.
struct Opening {
  std::size_t wall = 0;
  double middle_m = 0;  ///< along the wall
  double width_m = door_width_m, height_m = door_height_m;
  double frame_m = casing_m;  ///< of a door frame, which interrupts the skirting; 0: none
};

/// The openings of the ends, in the middle of the width `size_m.y()`.
std::vector<Opening> end_openings(const std::vector<RoomWall>& walls,
                                  const Eigen::Vector3d& size_m,
                                  const OpenEnds& open);

/// Floor, ceiling and the inner faces of the walls with their edges and skirting boards, around the
/// openings.
void raise_room(Shapes& shapes,
                const std::vector<Eigen::AlignedBox2d>& floor_m,
                const std::vector<RoomWall>& walls,
                double height_m,
                const std::vector<Opening>& openings);

/// The reveals of an opening: the faces of the wall, of wall_thickness_m, that it goes through.
void raise_reveals(Shapes& shapes, const RoomWall& wall, const Opening& opening);

/// Keeps the doorways at the ends free, so far beside and before them, and fits those at high x,
/// with reveals and frames; those at low x belong to the part before.
void fit_end_doorways(BuildingSite& site,
                      const std::vector<RoomWall>& walls,
                      const std::vector<Opening>& openings,
                      double beside_m,
                      double before_m);

/// The faces of a box from the origin to `size_m`, seen from inside, with the doorways of the open
/// ends.
void raise_outer_walls(Shapes& shapes, const Eigen::Vector3d& size_m, const OpenEnds& open);

}  // namespace vernier::sim::internal
