// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/camera.h"
#include "calib/lens_models.h"
#include "calib/rig_estimate.h"
#include "calib/rig_prior.h"

namespace vernier {

struct CalibrationOptions {
  CameraModel model = Radial1{};    ///< of every camera
  std::vector<CameraModel> models;  ///< one a camera where they differ; else empty
  double pixel_sigma_px = 0;        ///< noise of a pixel coordinate; 0: from the residuals
  int max_iterations = 200;
  std::vector<HeldParameter> held;        ///< parameters that are not estimated
  std::vector<ParameterPrior> known;      ///< parameters known beforehand, with a sigma
  std::optional<GaussianRigPrior> prior;  ///< what another calibration or a datasheet says
  BoardWarp warp = BoardWarp::known;      ///< free: the board's shape is estimated as well
  bool reject_outliers = true;            ///< see calib/calibration/outliers.h
  bool check_input = true;                ///< off: corners are known to be sound (repeated solves)
  /// The corner noise is known to be white (simulated corners): the covariance is the bound.
  bool white_noise = false;
};

/// Calibrates a rig from views of a board by the unified cost (Tina Memo 2017-001, Eq. 1),
///
///     χ²(a) = (a − a_0)ᵀ C_0⁻¹ (a − a_0) + Σ_i r_i(a)ᵀ W⁻¹ r_i(a)
///
/// r the reprojection residual, W = σ² I, the prior (a_0, C_0) optional, over the rig's parameters
/// and one pose of the board a frame, minimised by Ceres (calib/solver/minimise_reprojection.h).
/// The first camera is the rig's frame. Corners that no corner noise explains are left out and
/// listed. The result holds the minimum variance bound, the evidence, and as its covariance the
/// honest one: clustered by frame with at least three frames a parameter, its small-sample form
/// with fewer (kind "jackknife"). A held parameter has no variance. Where σ is to be estimated and
/// there is a prior, σ and the solution are found in turn; the prior's share of each parameter does
/// not count as the data's degrees of freedom. Throws Error where observations and prior do not
/// determine the rig, naming what stays free.
RigEstimate calibrate(BoardObservations observations, const CalibrationOptions& options = {});

}  // namespace vernier
