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
  std::vector<CameraModel> models;  ///< one per camera if they differ; else empty
  double pixel_sigma_px = 0;        ///< noise of a pixel coordinate; 0: from the residuals
  int max_iterations = 200;
  std::vector<HeldParameter> held;        ///< parameters that are not estimated
  std::vector<ParameterPrior> known;      ///< independent priors of single parameters
  std::optional<GaussianRigPrior> prior;  ///< from another calibration or a datasheet
  BoardWarp warp = BoardWarp::known;      ///< free: the board's warp is estimated too
  bool reject_outliers = true;            ///< see calib/calibration/outliers.h
  bool check_input = true;                ///< false: skip the checks (repeated solves)
  /// Random effects beside the unknowns (docs/uncertainty.md): the shape of the board, and its
  /// motion between the exposures of the cameras. With either, errors that are smooth over the
  /// board too.
  bool board_shape = false, motion = false;
  bool baseline_motion = false;  ///< the motion along the baseline has a size of its own
  /// The ratio of the board's spacings along x and y is an unknown (docs/calibration.md).
  bool board_aspect = false;
  /// The corner noise is known to be white (simulated corners): use the bound as covariance.
  bool white_noise = false;
};

/// Calibrates a rig from views of a board by the unified cost (Tina Memo 2017-001, Eq. 1),
///
///     χ²(a) = (a − a_0)ᵀ C_0⁻¹ (a − a_0) + Σ_i r_i(a)ᵀ W⁻¹ r_i(a)
///
/// with r the reprojection residual, W = σ² I and an optional prior (a_0, C_0), over the rig's
/// parameters and one board pose per frame, by Ceres (calib/solver/minimise_reprojection.h). The
/// first camera is the rig's frame. Outlier corners are excluded and listed. The result holds the
/// minimum variance bound, the evidence, and as its covariance the honest one, from the scatter of
/// the frames (calib/calibration/cluster_robust_covariance.h), of kind "clustered" with at least
/// three frames per parameter, "jackknife" with fewer. A held parameter has no variance. If σ is
/// estimated and there is a prior, σ and the solution are found in turn; the degrees of freedom do
/// not count the part of the parameters that the prior determines. With random effects the rig is
/// that of their cost (calib/noise/random_effects.h), the bound its inverse information and the
/// covariance from the scatter as above, with few frames in the shape of that bound; noise and
/// residuals of the summary stay those of the cost above. Throws Error, naming what is
/// undetermined, if observations and prior do not determine the rig; for noise that is negative or
/// not finite, and for no iterations.
RigEstimate calibrate(BoardObservations observations, const CalibrationOptions& options = {});

}  // namespace vernier
