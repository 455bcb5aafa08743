// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "calib/board_observations.h"
#include "calib/covariance.h"
#include "calib/pair_observations.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "calib/rig_prior.h"

namespace vernier {

/// A corner excluded from a calibration.
struct CornerOutlier {
  int frame = 0, camera = 0, id = 0;
  std::string image;
  Eigen::Vector2d pixel_px{0, 0};
  double residual_px = 0;  ///< its distance from the prediction of the final calibration
};

/// A matched pair excluded from a calibration.
struct PairOutlier {
  int image_pair = 0;
  std::size_t row = 0;  ///< among the pairs of the evidence
  Eigen::Vector4d pixels_px{0, 0, 0, 0};
  double residual_px = 0;  ///< its Sampson distance
};

/// Random effects of a calibration with the board's shape or its motion, and their components
/// (docs/uncertainty.md). Standard deviations; 0 for what was not estimated.
struct CalibrationEffects {
  double white_px = 0;                   ///< of a coordinate on its own
  double field_px = 0;                   ///< of an error that is smooth over the board
  double field_length_m = 0;             ///< over this length
  double motion_rad = 0;                 ///< of the board between exposures, about each axis
  double motion_m = 0;                   ///< along each axis
  double motion_baseline_m = 0;          ///< along the baseline where it is not motion_m, else 0
  double shape_plane_m = 0;              ///< of the board's corners along its x and y
  double shape_height_m = 0;             ///< along z
  std::vector<Eigen::Vector3d> shape_m;  ///< found, one per point of the target; empty without
};

/// The aspect of a board: the logarithm of its spacing along x over that along y, each relative to
/// the target's as it was given.
struct AspectEstimate {
  double value = 0;
  double sigma = 0;  ///< its standard deviation
};

/// Summary of a calibration. Residuals and their sums are those of the usual minimum, without
/// random effects and with an aspect known.
struct CalibrationSummary {
  std::string source = "board";  ///< board, pairs or combined
  double pixel_sigma_px = 0;     ///< standard deviation of a pixel coordinate
  double rms_px = 0;             ///< root mean square residual, per coordinate
  double chi2 = 0;               ///< sum of squared residuals over pixel_sigma_px²
  int dof = 0;                   ///< residuals less parameters, board poses included
  int views = 0;                 ///< frames used
  double prior_chi2 = 0;         ///< the priors' part of the cost; 0 without a prior
  int prior_dof = 0;             ///< number of parameters with a prior
  std::optional<CalibrationEffects> effects;
  std::optional<AspectEstimate> board_aspect;  ///< if estimated; the evidence's target has it
  std::vector<std::string> held;               ///< parameters that were not estimated
  std::vector<CornerOutlier> outliers;         ///< excluded corners
  std::vector<PairOutlier> pair_outliers;
  std::vector<std::string> warnings;
  std::vector<std::string> trust_warnings;  ///< why the result may be wrong, with a remedy
};

/// Everything needed to solve again, to propagate with the board poses, to compare and to combine.
struct CalibrationEvidence {
  BoardObservations observations;
  std::vector<int> frames;               ///< ascending
  std::vector<Pose> T_first_board;       ///< one per frame
  Eigen::Vector2d warp_m{0, 0};          ///< of the board (calib/board/board_warp.h)
  PairObservations pairs;                ///< matched corners, including outliers
  std::vector<GaussianRigPrior> priors;  ///< priors
};

/// A rig with its uncertainty: the content of a rig.json.
struct RigEstimate {
  Rig rig;
  std::optional<Covariance> covariance;           ///< used for sampling
  std::optional<Eigen::MatrixXd> covariance_mvb;  ///< the minimum variance bound
  std::optional<CalibrationSummary> calibration;
  std::optional<CalibrationEvidence> evidence;
  std::string other_keys;  ///< unknown keys of the file, as JSON text
};

/// The covariance used for sampling. Throws Error(`place`) if the estimate has none.
const Covariance& required_covariance(const RigEstimate& estimate, const std::string& place);

/// One flag per parameter of the rig that was held: those listed by the calibration, and those
/// without a variance. The variance of a rotation component is that of the rotation vector's. If
/// the estimate has no covariance, none is held. A rig file lists the others.
std::vector<bool> held_parameters(const RigEstimate& estimate);

/// The covariance over the parameters that are not held. Throws Error(`place`) if there is none.
GaussianRigPrior gaussian_prior_of(const RigEstimate& estimate, const std::string& place);

/// Renames the cameras, one name per camera, in the rig, the covariance and the held parameters.
/// Throws Error if the number of names is wrong or names are repeated.
void rename_cameras(RigEstimate& estimate, const std::vector<std::string>& names);

/// Selects one of an estimate's two covariances: the honest one (used for sampling) or the minimum
/// variance bound (reported by mrcal).
enum class CovarianceChoice { honest, mvb };

/// honest is the estimate's `covariance`, mvb its `covariance_mvb` (or the former if that is of
/// kind mvb); std::nullopt if it is missing.
std::optional<Covariance> chosen_covariance(const RigEstimate& estimate, CovarianceChoice choice);

/// The same; throws Error(`place`) if it is missing.
Covariance required_covariance(const RigEstimate& estimate,
                               CovarianceChoice choice,
                               const std::string& place);

}  // namespace vernier
