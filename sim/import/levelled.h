// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>

#include "sim/import/mesh.h"

namespace vernier::sim::internal {

/// The direction (unit) that is up in a building which leans by 0.02 to 5 degrees from z, z being
/// roughly up: that to which at least half of its floors and ceilings are level and half of its
/// walls upright. Nothing where half of the level surface is level to z already; and nothing where
/// the walls do not lean with the floors, as at a ramp.
std::optional<Eigen::Vector3d> leaning_up(const Mesh& mesh);

/// The mesh turned about the middle of its extent so that `up` becomes z, by the smallest rotation.
Mesh levelled(Mesh mesh, const Eigen::Vector3d& up);

/// By how much at least half of the level surface that comes within 0.1 m of a height leans from z,
/// radians: the slope of a floor. 0 without any, and where half of it lies level to 0.2 degrees.
double floor_slope_rad(const Mesh& mesh, double floor_m);

/// By how much the line between two points leans from z, radians, 0 to π/2.
double lean_rad(const Eigen::Vector3d& a, const Eigen::Vector3d& b);

/// Moves both ends of a line over its middle on the floor plan, at their heights.
void make_upright(Eigen::Vector3d& a_m, Eigen::Vector3d& b_m);

}  // namespace vernier::sim::internal
