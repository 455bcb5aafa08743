// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "calib/rig.h"
#include "stereo/segment.h"

namespace vernier::stereo::internal {

struct TriangulationOptions {
  double endpoint_sigma_px = 0.15;  ///< of either line across itself, for depth_sigma_m
  double max_depth_m =
      30;  ///< an end at or beyond this depth, or behind either camera, is unreliable
};

/// Triangulates the edge in space from a matched pair of image lines.
///
/// The right line's end points span a plane through the right camera with normal n (right frame).
/// The point on the left ray r at depth λ lies in it where n·(R λ r + T) = 0, so
///
///     λ = -n·T / n·(R r)
///
/// for either end of the left line: exact for any pose of the rig and any distortion, since end
/// points are undistorted one by one. Ends beyond `max_depth_m` (or with λ <= 0) are placed at that
/// depth and the segment is marked unreliable, as it is if a pixel cannot be unprojected with this
/// rig or an end is not in front of the right camera. Lines as planes through the cameras: Hartley
/// and Zisserman, "Multiple View Geometry" (2nd ed., 2004), section 15.4.
///
/// The depth error of the farther end comes from errors of σ pixels of both lines across
/// themselves. With ∇_l and ∇_r the gradients of n·(R λ r + T) by the pixel of the left end and by
/// that of the right line, ν the unit normal of the left image line,
///
///     σ_λ = σ √((∇_l·ν)² + |∇_r|²) / |n·(R r)|
///
/// which is Z² √2 σ / (f b sin φ) for equal cameras side by side and a line at φ to the baseline.
/// It is infinite if a pixel cannot be unprojected or that end is behind the right camera. Throws
/// Error unless the rig has two cameras.
SpaceSegment triangulate(const Rig& rig,
                         const StereoSegment& segment,
                         const TriangulationOptions& options = {});

std::vector<SpaceSegment> triangulate(const Rig& rig,
                                      std::span<const StereoSegment> segments,
                                      const TriangulationOptions& options = {});

/// The ends of a matched pair of image lines in space (metres, the rig's frame), a then b, and
/// their derivatives by the rig's parameters in the tangent and order of calib/rig.h.
struct SegmentTriangulation {
  Eigen::Matrix<double, 6, 1> ends_m;
  Eigen::Matrix<double, 6, Eigen::Dynamic> by_rig;
};

/// The same intersection with its derivatives. The left ends and the right line are held fixed in
/// the raw images; with w = R λ r + T the end in the right camera frame,
///
///     δλ = −(δn·w + n·δT + λ n·δ(R r)) / n·(R r)
/// Nothing where a pixel has no ray or an end is not in front of the rig.
std::optional<SegmentTriangulation> triangulate_with_jacobian(const Rig& rig,
                                                              const StereoSegment& segment);

}  // namespace vernier::stereo::internal
