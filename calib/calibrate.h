// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "calib/rig_estimate.h"

namespace vernier {

struct CalibrationOptions {
  CameraModel model = Radial1{};  ///< of every camera
  double pixel_sigma_px = 0;      ///< noise of a pixel coordinate; 0: estimated from the residuals
  int max_iterations = 200;
  /// The corner noise is known to be white (simulated corners): the covariance is the bound.
  bool white_noise = false;
};

/// Calibrates a rig from views of a board by the unified cost (Tina Memo 2017-001, Eq. 1) without
/// a prior,
///
///     χ²(a) = Σ_i r_i(a)ᵀ W⁻¹ r_i(a),   r the reprojection residual, W = σ² I,
///
/// over the rig's parameters and one pose of the board a frame, minimised by Ceres (dense Schur,
/// one analytic block a view). The first camera is the rig's frame. The result holds the minimum
/// variance bound, the evidence, and as its covariance the honest one: clustered by frame with at
/// least three frames a parameter, its small-sample form with fewer (kind "jackknife").
/// Throws Error where the observations do not determine the rig, naming what they leave free.
RigEstimate calibrate(BoardObservations observations, const CalibrationOptions& options = {});

/// Minimises the cost from a given start. Returns the state at the minimum; throws Error where
/// Ceres finds none.
BoardState minimise_reprojection(const BoardObservations& observations,
                                 BoardState start,
                                 int max_iterations = 200);

}  // namespace vernier
