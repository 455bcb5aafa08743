// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>

#include "calib/rig.h"

namespace vernier {

/// The pixels of one point in the rig's first camera and in another.
struct PixelPair {
  Eigen::Vector2d first_px;
  Eigen::Vector2d other_px;
};

/// A triangulated point (metres, first camera's frame) and its derivatives.
struct PointTriangulation {
  Eigen::Vector3d x_m;
  Eigen::Matrix<double, 3, 4> by_pixels;            ///< m / px: first u, v, then the other's
  Eigen::Matrix<double, 3, Eigen::Dynamic> by_rig;  ///< in the tangent and order of calib/rig.h
};

/// The point of a pixel pair by the "Mid2" method of Lee and Civera, "Triangulation: why optimize?"
/// (BMVC 2019), mrcal's default. With the rays v0 and v1 and the other camera's centre t, all in
/// the first camera's frame,
///
///     l0 = |v1 × t| / |v0 × v1|,   l1 = |v0 × t| / |v0 × v1|,   x = (l0 v0 + t + l1 v1) / 2
///
/// the midpoint of the two points that would meet if both rays were turned into one epipolar plane.
/// std::nullopt if a pixel has no ray, or if another sign of l0 or l1 brings the two points closer:
/// the rays diverge in front of the rig (their cheirality test). Throws Error unless `other` is a
/// camera of the rig and not its first.
std::optional<Eigen::Vector3d> triangulate_point(const Rig& rig,
                                                 const PixelPair& pair,
                                                 int other = 1);

/// The same with derivatives.
std::optional<PointTriangulation> triangulate_point_with_jacobian(const Rig& rig,
                                                                  const PixelPair& pair,
                                                                  int other = 1);

/// The pixels of a point in the first camera's frame in both cameras, inside their images or not.
/// std::nullopt if it is not in front of both.
std::optional<PixelPair> pixel_pair(const Rig& rig, const Eigen::Vector3d& x_m, int other = 1);

/// Depth of the closest approach of the rays of two pixels; not positive if they diverge. Throws
/// Error unless the rig is a pair.
double triangulated_depth_m(const Rig& rig, const PixelPair& pair);

/// The same; std::nullopt if the rig has no ray for one of the pixels.
std::optional<double> try_triangulated_depth_m(const Rig& rig, const PixelPair& pair);

}  // namespace vernier
