// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calib/data_and_prior.h"
#include "calib/pair_observations.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "calib/rig_prior.h"

namespace vernier {

/// Views of a board with their noise and the board's poses.
struct BoardTerm {
  CalibrationEvidence evidence;
  double pixel_sigma_px = 1;
};

/// All evidence about one rig: the terms of the unified cost (Tina Memo 2017-001, Eq. 1).
struct JointEvidence {
  std::vector<GaussianRigPrior> priors;  ///< independent of each other
  std::vector<BoardTerm> boards;
  PairObservations pairs;
};

struct JointOptions {
  std::vector<HeldParameter> held;
  /// Multiplies the stated noise of the pairs, from 0 on; 0: estimated from their residuals.
  double pair_sigma_scale = 0;
  bool reject_outliers = true;  ///< of the pairs
  /// The noise is known to be white (simulated): use the bound as covariance.
  bool white_noise = false;
  std::string place;  ///< what messages call the pairs, such as their file; empty: "pairs"
};

/// A calibration from all evidence, with the effect of the pairs on the prior knowledge.
struct JointCalibration {
  RigEstimate estimate;
  std::optional<Observability>
      observability;            ///< relative to all but the pairs, if those determine the rig
  double pair_sigma_scale = 1;  ///< the scale used
};

/// Minimises
///
///     χ²(a) = Σ (a − a_0)ᵀ C_0⁻¹ (a − a_0) + Σ_boards r(a)ᵀ r(a) / σ² + Σ_pairs ρ(r_i(a) / s)
///
/// by Ceres, from `start`; r is the reprojection residual of the boards and r_i the Sampson
/// residual of the pairs (calib/solver/epipolar_formulas.inc). Pairs have Huber's loss first, then
/// Tukey's with limit 5, both by iterated weights and balanced against the quadratic terms
/// (calib/solver/loss.h); a pair with final weight 0 is an outlier, listed and not counted.
/// Covariance: the sandwich A⁻¹ (B + P) A⁻¹ at the minimum, A = P + m Σ J Jᵀ
/// (calib/solver/pair_equations.h), B the scatter of the scores clustered by frame and image pair,
/// shrunk towards the shape of the bound (calib/calibration/cluster_robust_covariance.h). If there
/// are fewer than three image pairs and no board, image pairs are split into cells of 4 x 4 of the
/// left image, assuming that the noise of different cells is independent. `covariance_mvb` is the
/// bound of the inliers.
///
/// Throws Error if the terms leave a direction undetermined (naming it), or do not belong to one
/// rig.
JointCalibration calibrate_jointly(const JointEvidence& evidence,
                                   const Rig& start,
                                   const JointOptions& options = {});

/// Calibrates a pair of cameras from matched corners of any scene and a prior, after checks of the
/// input (check_pairs, check_sides, check_scene); starts at the prior's rig. A parameter that the
/// prior does not name is fixed. Throws Error if there are fewer pairs than free parameters.
JointCalibration calibrate_from_pairs(const PairObservations& pairs,
                                      const GaussianRigPrior& prior,
                                      const JointOptions& options = {});

/// Consistency of pairs and prior (calib/estimate/prior_consistency.h) in a calibration from both.
/// If parameters that the prior covers were held, the prior is conditioned on their values. Empty
/// result (p 1) if the prior does not cover all free parameters. The calibration may have used the
/// prior with standard deviations `looseness` times as large.
PriorConsistency consistency_with(const GaussianRigPrior& prior,
                                  const RigEstimate& estimate,
                                  double looseness = 1);

}  // namespace vernier
