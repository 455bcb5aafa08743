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

/// A segment must have finite end points at least 1 mm apart.
std::optional<WorldError> segment_error(const Eigen::Vector3d& a_m, const Eigen::Vector3d& b_m);

/// A surface must have at least three finite points, enclose an area and be planar to 1 mm.
std::optional<WorldError> surface_error(const std::vector<Eigen::Vector3d>& polygon_m);

/// A leg of a route must have at least two finite points.
std::optional<WorldError> route_error(const std::vector<Eigen::Vector2d>& points_m);

/// Templates by name. Throws Error for a template without a name or with a duplicate one.
std::map<std::string, const WorldTemplate*> templates_by_name(const WorldDescription& description);

/// Checks all preconditions of build_world; throws Error with template and index as the place.
void check_world(const WorldDescription& description);

}  // namespace vernier::sim::internal
