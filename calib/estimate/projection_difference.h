// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <optional>
#include <vector>

#include "calib/covariance.h"
#include "calib/pose.h"
#include "calib/rig.h"

namespace vernier::internal {

struct ProjectionDifferenceOptions {
  std::vector<double> distances_m{1, 3, 10, std::numeric_limits<double>::infinity()};
  Eigen::Vector2i grid{20, 15};  ///< columns and rows of pixels over each image
  /// The alignment is fitted to the focus: pixels within this share of half the image's diagonal
  /// from its middle. Calibrations say little of the corners, which would spoil the fit.
  double focus_share = 0.7;
};

/// Lengths of difference vectors over an image.
struct DifferenceSize {
  double mean_px = 0, rms_px = 0, max_px = 0;
};

/// What one camera of b makes of points that its counterpart in a sees at one distance. A pixel
/// without a ray in a, or without an image in b, holds NaN.
struct DifferenceMap {
  int camera = 0;
  double distance_m = 0;                   ///< along the ray; infinite allowed
  std::vector<Eigen::Vector2d> before_px;  ///< one a grid pixel, row by row
  std::vector<Eigen::Vector2d> after_px;   ///< the alignment taken out
  std::vector<double> expected_px;         ///< rms length if both are right; empty where unknown
  DifferenceSize before, after, in_focus;  ///< the last: after, and within the focus
  double expected_rms_px = 0, expected_in_focus_px = 0;
};

/// Two rigs compared by where they see the same points:
///
///     e = π_b(T_b_a π_a⁻¹(q, d)) − q
///
/// over a grid of pixels q of every camera of a and the distances d along the ray. The rigs' frames
/// are those of their left cameras, which no user can see, so the rigid T_b_a is fitted to take out
/// what differs by the frame alone: least squares of e over all cameras and distances, one motion
/// for the rig (mrcal's projection diff fits one a camera by angles; here a change of the pose
/// between the cameras must stay visible). To first order e = P (J_b δ_b − J_a δ_a), with P the
/// part that the fit cannot take out, so its covariance is P (J_a C_a J_aᵀ + J_b C_b J_bᵀ) Pᵀ if
/// both are right and independent.
struct ProjectionDifference {
  Pose T_b_a;
  std::vector<std::vector<Eigen::Vector2d>> pixels_px;  ///< the grid of each camera
  std::vector<DifferenceMap> maps;                      ///< camera by camera, distance by distance
  DifferenceSize before, after, in_focus;               ///< over all maps
  std::optional<double> expected_rms_px;                ///< over all maps
  int left_out = 0;                                     ///< pixel and distance pairs with NaN
};

/// The expected size is given where both covariances are. Throws Error where the cameras disagree
/// (calib/rig_difference.h), a distance is not above 0, or fewer than 6 pixels can be compared.
ProjectionDifference projection_difference(const Rig& a,
                                           const Rig& b,
                                           const ProjectionDifferenceOptions& options = {},
                                           const Covariance* covariance_a = nullptr,
                                           const Covariance* covariance_b = nullptr);

}  // namespace vernier::internal
