// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "calib/pose.h"
#include "calib/rig.h"
#include "localise/place.h"

namespace vernier::localise {

/// The same corner at two moments: indices into the lists of both.
struct CornerLink {
  int from = 0, to = 0;
};

struct CornerLinkOptions {
  double min_similarity = 0.8;
  double min_margin = 0.02;  ///< least lead in similarity over the second best, both ways
  double max_motion_px = std::numeric_limits<double>::infinity();  ///< of the left pixel
};

/// Links corners that are each other's most similar, more similar than any other by the margin.
/// Corners whose descriptors differ in size are never linked.
std::vector<CornerLink> link_corners(std::span<const StereoCorner> from,
                                     std::span<const StereoCorner> to,
                                     const CornerLinkOptions& options = {});

/// The same, among corners whose pixels a motion predicts to within `window_px` in both images.
/// Corners that look alike, as those of repeated texture, are told apart by where they are. Corners
/// whose pixels have no common point are not linked. Throws Error unless the rig has two cameras.
std::vector<CornerLink> link_corners_near(const Rig& rig,
                                          std::span<const StereoCorner> from,
                                          std::span<const StereoCorner> to,
                                          const Pose& T_from_to,
                                          double window_px,
                                          const CornerLinkOptions& options = {});

struct StepOptions {
  double gate_probability = 0.999;  ///< that a right link is taken for one
  double confidence = 0.9999;       ///< of having drawn three right links
  int max_draws = 1000;             ///< of three links
  int min_inliers = 6;
  std::uint64_t seed = 1;  ///< with the step, it fixes every draw
  std::uint32_t step = 0;  ///< its number in a trajectory
  bool with_rig = true;    ///< whether by_rig is computed
  /// Covariance of the rig's parameters, which widens the gates; empty if it is not known.
  Eigen::MatrixXd calibration;
};

/// The motion of a rig between two moments.
struct MotionStep {
  Pose T_from_to;  ///< the later left camera's pose in the frame of the earlier
  /// Of T_from_to in the tangent of retract() (rad, m), from the noise of the corners, whose
  /// variance is measured by the residuals.
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
  /// Derivative of T_from_to by the rig's parameters (calib/rig.h): 6 x parameters. An error of the
  /// calibration is common to all steps of a trajectory.
  Eigen::Matrix<double, 6, Eigen::Dynamic> by_rig;
  std::vector<CornerLink> inliers;
  int links = 0;  ///< that were given
  /// Of odometry_path(): in how much of the image links agree on another motion, relative to the
  /// inliers (cells of 12 x 12). Above 1/2 it is not clear which of the two is the rig's.
  double other_motion = 0;
  double chi2 = 0;  ///< of the inliers, by their covariances
  int dof = 0;      ///< five for each inlier, less six
};

/// The motion that explains the links, by three steps:
///
///  1. consensus: motions of three links each, drawn until three right ones are among them with the
///     wanted confidence (Fischler and Bolles 1981); the best has the least sum of truncated
///     squares (MSAC, Torr and Zisserman 2000), each cell of the image counting once, of
///
///         d² = rᵀ (J C Jᵀ + C_z)⁻¹ r,   r = z_to − π(T⁻¹ x)
///
///     with x the point triangulated at the earlier moment, C its covariance, J = ∂π / ∂x, and C_z
///     that of z_to and of what the rig's error does to its distance from a point's pixels;
///  2. refinement: the motion and the points of all links within the gate, jointly, by
///     Levenberg and Marquardt on the eight pixel coordinates of each, the points eliminated (Schur
///     complement); the gate is applied again until the links stay the same;
///  3. covariance: the inverse of the reduced normal equations, times χ² / dof, 1e-6 at least, as
///  far
///     as the residuals of single links do not say otherwise (HC3,
///     localise/odometry/step_refinement.h).
///
/// std::nullopt if fewer than min_inliers links agree. Throws Error unless the rig has two cameras,
/// the links are indices of corners, and the options are in range.
std::optional<MotionStep> estimate_step(const Rig& rig,
                                        std::span<const StereoCorner> from,
                                        std::span<const StereoCorner> to,
                                        std::span<const CornerLink> links,
                                        const StepOptions& options = {});

}  // namespace vernier::localise
