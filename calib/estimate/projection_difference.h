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
  /// The alignment is fitted to the focus: pixels within this fraction of half the image's diagonal
  /// from its centre, and 80 degrees of the axis. Image corners are poorly calibrated and would
  /// distort the fit.
  double focus_share = 0.7;
};

/// Lengths of difference vectors over an image.
struct DifferenceSize {
  double mean_px = 0, rms_px = 0, max_px = 0;
};

/// Differences for one camera at one distance: points seen by the camera of a, projected by that of
/// b. NaN for a pixel without a ray in a or without an image in b.
struct DifferenceMap {
  int camera = 0;
  double distance_m = 0;                   ///< along the ray; infinite allowed
  std::vector<Eigen::Vector2d> before_px;  ///< one per grid pixel, row by row
  std::vector<Eigen::Vector2d> after_px;   ///< with the alignment removed
  std::vector<double> expected_px;         ///< rms length if both are correct; empty if unknown
  DifferenceSize before, after, in_focus;  ///< the last: after, and within the focus
  double expected_rms_px = 0, expected_in_focus_px = 0;
};

/// Compares two rigs by the projections of the same points,
///
///     e = π_b(T_b_a π_a⁻¹(q, d)) − q
///
/// over a grid of pixels q of every camera of a and the distances d along the ray. The rigs' frames
/// are those of their left cameras, which are not observable, so the rigid T_b_a is fitted to
/// remove differences due to the frame alone: least squares of e over all cameras and distances,
/// one motion per rig (mrcal's projection diff fits one per camera by angles; here a change of the
/// relative pose must remain visible). To first order e = P (J_b δ_b − J_a δ_a), with P the
/// projection onto the part that the fit cannot remove, so its covariance is P (J_a C_a J_aᵀ + J_b
/// C_b J_bᵀ) Pᵀ if both are correct and independent.
struct ProjectionDifference {
  Pose T_b_a;
  std::vector<std::vector<Eigen::Vector2d>> pixels_px;  ///< the grid of each camera
  std::vector<DifferenceMap> maps;                      ///< camera by camera, distance by distance
  DifferenceSize before, after, in_focus;               ///< over all maps
  std::optional<double> expected_rms_px;                ///< over all maps
  int left_out = 0;  ///< number of (pixel, distance) pairs with NaN
};

/// The expected size is given if both covariances are. Throws Error if the cameras differ
/// (calib/rig_difference.h), a distance is not above 0, or fewer than 6 pixels can be compared.
ProjectionDifference projection_difference(const Rig& a,
                                           const Rig& b,
                                           const ProjectionDifferenceOptions& options = {},
                                           const Covariance* covariance_a = nullptr,
                                           const Covariance* covariance_b = nullptr);

}  // namespace vernier::internal
