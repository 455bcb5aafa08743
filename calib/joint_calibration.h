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

/// Views of a board with their own noise, and where the board stood.
struct BoardTerm {
  CalibrationEvidence evidence;
  double pixel_sigma_px = 1;
};

/// Everything that is known of one rig: the terms of the unified cost (Tina Memo 2017-001, Eq. 1).
struct JointEvidence {
  std::vector<GaussianRigPrior> priors;  ///< independent of each other
  std::vector<BoardTerm> boards;
  PairObservations pairs;
};

struct JointOptions {
  std::vector<HeldParameter> held;
  /// Multiplies the noise that the pairs state; 0: from their residuals.
  double pair_sigma_scale = 0;
  bool reject_outliers = true;  ///< of the pairs
  /// Noise is known to be white (simulated): the covariance is the bound.
  bool white_noise = false;
  std::string place;  ///< what messages call the pairs, such as their file; empty: "pairs"
};

/// A rig from all of it, with what the pairs did to what was known before them.
struct JointCalibration {
  RigEstimate estimate;
  std::optional<Observability> observability;  ///< against all but the pairs, where those decide
  double pair_sigma_scale = 1;                 ///< that was used
};

/// Minimises
///
///     χ²(a) = Σ (a − a_0)ᵀ C_0⁻¹ (a − a_0) + Σ_boards r(a)ᵀ r(a) / σ² + Σ_pairs ρ(r_i(a) / s)
///
/// by Ceres, from `start`; r the reprojection residuals of the boards and the Sampson residual of
/// the pairs (calib/solver/epipolar_formulas.inc). Pairs count by Huber's loss first, then by
/// Tukey's with limit 5, both by iterated weights and balanced against the quadratic terms
/// (calib/solver/loss.h); one whose weight is 0 in the end is an outlier, listed and not counted.
/// Covariance: the sandwich A⁻¹ (B + P) A⁻¹ of that minimum, A = P + m Σ J Jᵀ
/// (calib/solver/pair_equations.h), B the scatter of the scores clustered by
/// frame and image pair; its small-sample form (calib/calibration/small_sample_covariance.h) below
/// three clusters a parameter. Fewer than three image pairs and no board are split into cells of 4
/// x 4 of the left image, which takes noise of different cells for independent. `covariance_mvb` is
/// the bound of the inliers.
///
/// Throws Error where the terms leave a direction free (naming it), or do not belong to one rig.
JointCalibration calibrate_jointly(const JointEvidence& evidence,
                                   const Rig& start,
                                   const JointOptions& options = {});

/// The calibration of a pair of cameras from matched corners of any scene and what was known
/// before, with its input looked at first (check_pairs, check_sides, check_scene); starts at the
/// prior's rig. A parameter that the prior does not name is known exactly. Throws Error where there
/// are fewer pairs than free parameters.
JointCalibration calibrate_from_pairs(const PairObservations& pairs,
                                      const GaussianRigPrior& prior,
                                      const JointOptions& options = {});

/// Whether pairs and prior agree (calib/estimate/prior_consistency.h), of a calibration from both;
/// where parameters that the prior knows were held, it is the prior given these values. Nothing (p
/// 1) where the prior does not know all that is free. The calibration may have used the prior with
/// standard deviations `looseness` times as large.
PriorConsistency consistency_with(const GaussianRigPrior& prior,
                                  const RigEstimate& estimate,
                                  double looseness = 1);

}  // namespace vernier
