// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "sim/world.h"

namespace vernier::sim::internal {

/// Unit normal n and distance d of the plane n·x = d through a polygon, by Newell's sum
///
///     n ~ Σ (p_i - p_0) × (p_i+1 - p_0),   d = mean of n·p_i,
///
/// counter-clockwise about n. n is zero for a polygon without area (thinner than 1e-10 m).
struct PolygonPlane {
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  double distance_m = 0;
};
PolygonPlane polygon_plane(const std::vector<Eigen::Vector3d>& polygon_m);

/// Whether a point is inside the polygon's outline as seen along an axis (0 to 2), by the even-odd
/// rule.
bool inside_outline(const Eigen::Vector3d& at_m,
                    const std::vector<Eigen::Vector3d>& polygon_m,
                    int axis);

/// Splits a simple planar polygon into convex pieces, each a loop of indices into `polygon_m`,
/// counter-clockwise about the normal: ear clipping, then removal of every unnecessary cut (Hertel
/// and Mehlhorn, "Fast triangulation of simple polygons", 1983; at most four times the minimum
/// number of pieces). A hole may be joined to the border by a cut traversed in both directions. A
/// polygon that is convex to 1e-9 m gives one piece, one without area none.
std::vector<std::vector<int>> convex_pieces(const std::vector<Eigen::Vector3d>& polygon_m);

/// A convex piece of a world surface: plane normal·x = distance, its vertices counter-clockwise
/// about the normal, and a bounding sphere.
struct ConvexSurface {
  Eigen::Vector3d normal;
  double distance_m = 0;
  Eigen::Vector3d centre_m;
  double radius_m = 0;
  int first_vertex = 0, vertex_count = 0;
};

/// All surfaces of a world as convex pieces, with a common list of vertices.
struct ConvexSurfaces {
  std::vector<ConvexSurface> pieces;
  std::vector<Eigen::Vector3d> vertices_m;
};
ConvexSurfaces convex_surfaces(const World& world);

/// The bounding box of a piece.
Eigen::AlignedBox3d box_of(const ConvexSurfaces& surfaces, const ConvexSurface& piece);

}  // namespace vernier::sim::internal
