// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

namespace vernier::sim::internal {

/// One side of a shadow: x is inside if inward·x > tolerance. The side contains the eye, which is
/// the origin here, and an edge of the surface.
struct ShadowSide {
  Eigen::Vector3d inward;
  double tolerance;  ///< |inward| x 1 nm: within it, x counts as on the side
};

/// The volume hidden by a convex surface from an eye at the origin: the points with
///
///     normal·x > distance + gap   and   inward_i·x > 0  for every edge i.
struct Shadow {
  Eigen::Vector3d normal;  ///< unit, away from the eye
  double distance_m;       ///< of the eye from the surface's plane, not negative
  std::span<const ShadowSide> sides;
};

/// If the eye is closer to a surface's plane, it sees the surface edge-on, and it hides nothing.
inline constexpr double edge_on_m = 1e-9;

/// The side through edge p -> q of a polygon that runs counter-clockwise about the shadow's normal.
ShadowSide shadow_side(const Eigen::Vector3d& p, const Eigen::Vector3d& q);

/// An interval of a segment, t in [t0, t1].
struct Stretch {
  double t0 = 0, t1 = 0;
};

/// An interval of a segment, t in [t0, t1], hidden on one or both sides. A segment that runs along
/// the border of a shadow is hidden on that one side; it counts as hidden if it is so on both, as
/// behind the seam of two walls, but not behind a single edge.
struct OccludedInterval {
  static constexpr int left = 1, right = 2, both = 3;
  double t0 = 0, t1 = 0;
  int hands = 0;  ///< bits of the sides; 0: nothing is hidden
};

/// The part of x(t) = a + t (b - a) within [t0, t1] that `shadow` hides.
OccludedInterval occluded_interval(const Shadow& shadow,
                                   const Eigen::Vector3d& a,
                                   const Eigen::Vector3d& b,
                                   double t0,
                                   double t1,
                                   double gap_m);

enum class PointInShadow { outside, on_border, inside };

/// Position of x relative to a shadow. If x is on its border, appends the inward normals of the
/// sides it lies on to `touched`, if given.
PointInShadow point_in_shadow(const Shadow& shadow,
                              const Eigen::Vector3d& x,
                              double gap_m,
                              std::vector<Eigen::Vector3d>* touched = nullptr);

/// Points 10 nm around x, across its ray: one in each sector between the sides it touches. A point
/// on the border of shadows is hidden if all of these are: behind the seam of two walls, not behind
/// a single edge.
std::vector<Eigen::Vector3d> points_around(const Eigen::Vector3d& x,
                                           const std::vector<Eigen::Vector3d>& touched);

/// Projection of part of a segment x(t) = a + t (b - a), in normalised coordinates: a straight line
/// from x0 to x1, at depths z0 to z1.
struct ProjectedSegment {
  ProjectedSegment(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Stretch& stretch);

  /// The t of image position x0 + s (x1 - x0): equal steps in the image are not equal in space.
  double t_at(double s) const {
    if (s >= 1) return stretch.t1;
    const double share = s * z0 / (z1 * (1 - s) + s * z0);
    return stretch.t0 + share * (stretch.t1 - stretch.t0);
  }

  Stretch stretch;
  Eigen::Vector2d x0, x1;
  double z0, z1;
};

/// Hidden intervals within this distance in t are merged; a visible one no longer than
/// `min_stretch` is a numerical gap.
inline constexpr double touching = 1e-9;
inline constexpr double min_stretch = 3e-9;

/// The parts of `whole` outside the hidden intervals, ascending. Reorders `hidden`.
void subtract_intervals(const Stretch& whole,
                        std::vector<OccludedInterval>& hidden,
                        std::vector<Stretch>& visible);

}  // namespace vernier::sim::internal
