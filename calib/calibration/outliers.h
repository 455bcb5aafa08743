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

/// What remains when corners that no corner noise explains are left out.
struct RobustFit {
  BoardObservations inliers;
  BoardState state;  ///< at the frames that are left
  std::vector<CornerOutlier> outliers;
};

/// Residuals of every corner (prediction less pixel, px), view by view. Throws Error where the
/// state does not have a view's frame or camera.
using CornerResiduals = std::vector<std::vector<Eigen::Vector2d>>;
CornerResiduals corner_residuals(const BoardObservations& observations, const BoardState& state);

/// Standard deviation of a coordinate from the median length of a residual, 1.1774 σ for a normal
/// error in two coordinates (Rayleigh), which fewer than a half of wrong corners cannot ruin.
double robust_pixel_sigma(const CornerResiduals& residuals);

/// Where wrong corners pull on nothing, or nothing where the least-squares minimum `state` has none
/// of them: no outlier by the rule below, and no view that fits three times worse than is usual for
/// its camera. The cost is minimised with Huber's loss (Huber 1964), then with Tukey's redescending
/// one (Beaton and Tukey 1974), both by iterated weights on the length of a corner's residual in
/// robust standard deviations of its camera.
std::optional<BoardState> robust_minimum(const BoardObservations& observations,
                                         const BoardState& state,
                                         const ReprojectionProblem& problem,
                                         double limit = 6);

/// What `state` takes for outliers, and the state at the frames that are left; nothing is
/// minimised.
///
/// A corner is an outlier where its residual is longer than `limit` standard deviations, the robust
/// one of its camera's corners and that of its eight neighbours on the board, whichever is larger:
/// a lens that the model does not fit moves neighbours as well, and is no reason to leave corners
/// out. A view is one where most of its residuals are that long, or where what is left of it fixes
/// no pose. With 6 a corner of normal error is lost once in 6e7.
RobustFit outliers_at(const BoardObservations& observations,
                      const BoardState& state,
                      double limit = 6);

/// Cameras that would lose more than half of their views, in words: with so many wrong, those that
/// are left decide nothing. Empty where there is none.
std::vector<std::string> overrejected_cameras(const BoardObservations& observations,
                                              const BoardObservations& inliers,
                                              const Rig& rig);

/// Sets how far outliers lie from where `state` predicts them: not a number where it does not have
/// their frame. Throws Error where the rig has no such camera or the target no such corner.
void measure_outliers(const std::vector<Eigen::Vector3d>& target_m,
                      const BoardState& state,
                      std::vector<CornerOutlier>& outliers);

}  // namespace vernier::internal
