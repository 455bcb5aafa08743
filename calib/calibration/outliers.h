// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "calib/solver/reprojection_problem.h"

namespace vernier::internal {

/// Result of excluding outlier corners.
struct RobustFit {
  BoardObservations inliers;
  BoardState state;  ///< at the frames that are left
  std::vector<CornerOutlier> outliers;
};

/// Residuals of every corner (prediction minus pixel, px), view by view. Throws Error if the state
/// lacks a view's frame or camera.
using CornerResiduals = std::vector<std::vector<Eigen::Vector2d>>;
CornerResiduals corner_residuals(const BoardObservations& observations, const BoardState& state);

/// Standard deviation of a coordinate from the median length of a residual, 1.1774 σ for a normal
/// error in two coordinates (Rayleigh). Robust if fewer than half of the corners are wrong.
double robust_pixel_sigma(const CornerResiduals& residuals);

/// The minimum of a robust cost; std::nullopt if the least-squares minimum `state` shows no wrong
/// corners: no outlier by the rule below, and no view with an rms three times the usual one of its
/// camera. The cost is minimised with Huber's loss (Huber 1964), then with Tukey's redescending
/// loss (Beaton and Tukey 1974), both by iterated weights on the length of a corner's residual in
/// robust standard deviations of its camera.
std::optional<BoardState> robust_minimum(const BoardObservations& observations,
                                         const BoardState& state,
                                         const ReprojectionProblem& problem,
                                         double limit = 6);

/// Frames whose board is in a wrong local minimum at `state`: those with an outlying view (below)
/// get the pose that fits all their views best, with the rig as it is, if it halves their rms.
/// Returns whether there was one.
bool place_outlying_boards(const BoardObservations& observations,
                           BoardState& state,
                           double limit = 6);

/// Outliers at `state`, and the state at the remaining frames; nothing is minimised.
///
/// A corner is an outlier if its residual is longer than `limit` standard deviations: the larger of
/// the robust one of its camera's corners and that of its eight neighbours on the board (a lens
/// that the model does not fit moves neighbours too, which is no reason to exclude corners).
/// Neighbours that are outliers are then replaced by the next ones, until no further corner stands
/// out that is moved like an outlier beside it and has no neighbour moved by part of that: wrong
/// corners side by side hide each other, a lens moves corners by degrees. A view
/// is an outlier if most of its residuals are that long, or if the rest of it does not determine a
/// pose. With 6, a corner with normal error is lost once in 6e7.
RobustFit outliers_at(const BoardObservations& observations,
                      const BoardState& state,
                      double limit = 6);

/// Messages about cameras that would lose more than half of their views: the rest is then too small
/// to decide which are wrong. Empty if there is none.
std::vector<std::string> overrejected_cameras(const BoardObservations& observations,
                                              const BoardObservations& inliers,
                                              const Rig& rig);

/// The images all of whose corners are outliers, as view_label names them.
std::vector<std::string> images_left_out(const std::vector<CornerOutlier>& outliers,
                                         const BoardObservations& inliers);

/// Sets the distance of outliers from their prediction by `state`: NaN if the state lacks their
/// frame. Throws Error if the rig lacks the camera or the target the corner.
void measure_outliers(const std::vector<Eigen::Vector3d>& target_m,
                      const BoardState& state,
                      std::vector<CornerOutlier>& outliers);

}  // namespace vernier::internal
