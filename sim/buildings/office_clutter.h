// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "calib/statistics/random.h"
#include "sim/buildings/building_site.h"
#include "sim/buildings/wire_shapes.h"

namespace vernier::sim::internal {

// Clutter: loose features, different in every room.

/// Books and cartons on the boards of a bookshelf at `x_m` along the wall.
void fill_bookshelf(BuildingSite& site,
                    const QuarterFrame& frame,
                    double x_m,
                    vernier::internal::RandomStream& draws);

/// Sheets of paper on a rectangle of wall (a notice board), from `low_m` to `high_m` (x, z).
void pin_papers(BuildingSite& site,
                const QuarterFrame& frame,
                const Eigen::Vector2d& low_m,
                const Eigen::Vector2d& high_m,
                vernier::internal::RandomStream& draws);

/// Stacks of paper and books and small boxes on a top of `size_m` whose near left corner is
/// `corner_m`.
void litter_top(BuildingSite& site,
                const QuarterFrame& frame,
                const Eigen::Vector3d& corner_m,
                const Eigen::Vector2d& size_m,
                int things,
                vernier::internal::RandomStream& draws);

/// Cartons on top of a cupboard.
void stack_cartons(BuildingSite& site,
                   const QuarterFrame& frame,
                   const Eigen::Vector3d& corner_m,
                   const Eigen::Vector2d& size_m,
                   vernier::internal::RandomStream& draws);

/// Framed pictures, calendars and posters of random sizes on free wall.
void hang_pictures(BuildingSite& site,
                   const RoomWall& wall,
                   int tries,
                   vernier::internal::RandomStream& draws);

/// Cartons on the floor along a wall.
void drop_cartons(BuildingSite& site,
                  const RoomWall& wall,
                  int tries,
                  vernier::internal::RandomStream& draws);

/// A duct in a corner, conduits with their junction boxes up a wall, a stretch of cable trunking.
void run_cables(BuildingSite& site, const RoomWall& wall, vernier::internal::RandomStream& draws);

}  // namespace vernier::sim::internal
