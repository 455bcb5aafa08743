// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "localise/place.h"
#include "sim/experiment.h"
#include "sim/visibility.h"
#include "sim/world.h"

namespace vernier::sim::internal {

inline constexpr double robot_radius_m = 0.12;
inline constexpr double robot_top_m = 0.2;  ///< above its camera

/// Half the range across the route (metres) and of heading (radians).
struct ProtocolSpan {
  double across_m, heading_rad;
};
ProtocolSpan span(QueryProtocol protocol);

/// Bounding box of the poses that are accepted: of segments and surfaces, from the floor at 0 or
/// lower, and of the route with 0.6 m around it.
WorldExtent standing_box(const World& world);

/// Whether the point is inside the polygon's outline on the floor.
bool inside_plan(const Eigen::Vector2d& at_m, const std::vector<Eigen::Vector3d>& polygon_m);

/// Whether a surface keeps a robot of the given radius and height from standing at a point.
bool blocks(const WorldSurface& surface,
            const Eigen::Vector2d& at_m,
            double radius_m,
            double height_m);

/// Whether a robot of the given radius can stand at a point: no surface below `height_m` is closer
/// than the radius.
bool is_free(const World& world, const Eigen::Vector2d& at_m, double radius_m, double height_m);

/// Why a robot's camera cannot be at a pose, as a predicate for a sentence about the pose; empty if
/// it can. It cannot be outside the bounding box of the world's segments and surfaces and of 0.6 m
/// around its route; below the floor; above a level surface over the point, such as a ceiling;
/// where a robot of 0.12 m radius that extends 0.2 m above its camera could not stand; and, in a
/// world with a route, in a space that surfaces at the camera's height close off from the route
/// (the inside of a wall or a cupboard).
std::string standing_fault(const Visibility& visibility,
                           const localise::Pose2D& pose,
                           double eye_height_m);

}  // namespace vernier::sim::internal
