// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "calib/pose.h"
#include "sim/import/mesh.h"
#include "sim/world.h"

namespace vernier::sim::internal {

/// A camera of a reconstruction: T_camera_world in its units.
struct PathCamera {
  std::string name;
  Pose T_camera_world;
};

/// Cameras of COLMAP's images.txt in a folder, by name, digits in it by the number they are. Throws
/// Error naming file and line.
std::vector<PathCamera> read_camera_path(const std::filesystem::path& folder);

/// The direction that is up: against the mean of the cameras' y axes, then the mean direction of
/// the lines within 15 degrees of it, weighted by length. Throws Error(place) for cameras that look
/// in all directions (a mean axis shorter than a half) or none.
Eigen::Vector3d up_of(const std::vector<PathCamera>& cameras,
                      const Mesh& mesh,
                      const std::string& place);

/// Turns mesh and cameras so that `up` becomes z, by the smallest rotation.
void level(const Eigen::Vector3d& up, Mesh& mesh, std::vector<PathCamera>& cameras);

/// Median height of levelled cameras, in their units.
double median_height(const std::vector<PathCamera>& cameras);

/// The way of levelled cameras, in the order given, as legs on the floor: metres, in the plan of a
/// world whose coordinates are `unit_m` times theirs less `origin_m`. A new leg begins where two
/// are more than 3 m apart; steps below 0.1 m are joined (Ramer, Douglas and Peucker, 5 cm).
std::vector<RouteLeg> route_of(const std::vector<PathCamera>& cameras,
                               double unit_m,
                               const Eigen::Vector2d& origin_m);

}  // namespace vernier::sim::internal
