// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "sim/world.h"

namespace vernier::sim::internal {

/// A fault of part of a world and its remedy; the caller adds the place.
struct WorldError {
  std::string fault, remedy;
};

/// A point must be finite and within the largest coordinate (world_limits.h) of the origin.
std::optional<WorldError> point_error(const Eigen::Vector3d& point_m);

/// A segment must have end points as above, at least 1 mm apart.
std::optional<WorldError> segment_error(const Eigen::Vector3d& a_m, const Eigen::Vector3d& b_m);

/// A surface must have three to most_polygon_points points as above, enclose an area and be planar
/// to 1 mm.
std::optional<WorldError> surface_error(const std::vector<Eigen::Vector3d>& polygon_m);

/// A leg of a route must have at least two points as above.
std::optional<WorldError> route_error(const std::vector<Eigen::Vector2d>& points_m);

/// Largest distance along an axis of a template's points from its origin, however it is turned.
double reach_m(const FeatureSet& features);

/// An instance of a template of that reach must have a finite position and turn, and lie within the
/// largest coordinate as a whole.
std::optional<WorldError> instance_error(const WorldInstance& instance, double template_reach_m);

/// The whole must have no more features, objects and metres of route than world_limits.h allows;
/// counted without instantiating. Instances of unknown templates count nothing.
std::optional<WorldError> size_error(const WorldDescription& description);

/// Something of the world must lie at a robot's height: its floor is z = 0. Asked of files only; a
/// world made in a program may be a part of another.
std::optional<WorldError> floor_error(const WorldDescription& description);

/// Templates by name. Throws Error for a template without a name or with a duplicate one.
std::map<std::string, const WorldTemplate*> templates_by_name(const WorldDescription& description);

/// Checks all preconditions of build_world; throws Error with template and index as the place.
void check_world(const WorldDescription& description);

}  // namespace vernier::sim::internal
