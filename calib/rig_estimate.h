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

/// A corner left out of a calibration.
struct CornerOutlier {
  int frame = 0, camera = 0, id = 0;
  std::string image;
  Eigen::Vector2d pixel_px{0, 0};
  double residual_px = 0;  ///< its distance from where the final calibration predicts it
};

/// A matched pair left out of a calibration.
struct PairOutlier {
  int image_pair = 0;
  std::size_t row = 0;  ///< among the pairs of the evidence
  Eigen::Vector4d pixels_px{0, 0, 0, 0};
  double residual_px = 0;  ///< its Sampson distance
};

/// How a calibration went.
struct CalibrationSummary {
  std::string source = "board";         ///< board, pairs or combined
  double pixel_sigma_px = 0;            ///< standard deviation of a pixel coordinate
  double rms_px = 0;                    ///< root mean square residual, per coordinate
  double chi2 = 0;                      ///< sum of squared residuals over pixel_sigma_px²
  int dof = 0;                          ///< residuals less parameters, board poses included
  int views = 0;                        ///< frames used
  double prior_chi2 = 0;                ///< the priors' part of the cost; 0 without one
  int prior_dof = 0;                    ///< parameters that the priors know
  std::vector<std::string> held;        ///< parameters that were not estimated
  std::vector<CornerOutlier> outliers;  ///< corners left out
  std::vector<PairOutlier> pair_outliers;
  std::vector<std::string> warnings;
  std::vector<std::string> trust_warnings;  ///< why the result may be wrong, and what to do
};

/// All that is needed to solve again, to propagate with the board poses, to compare and combine.
struct CalibrationEvidence {
  BoardObservations observations;
  std::vector<int> frames;               ///< ascending
  std::vector<Pose> T_first_board;       ///< one a frame
  Eigen::Vector2d warp_m{0, 0};          ///< of the board (calib/board/board_warp.h)
  PairObservations pairs;                ///< matched corners, outliers and all
  std::vector<GaussianRigPrior> priors;  ///< what was known before the rest
};

/// A rig and how well it is known: the content of a rig.json.
struct RigEstimate {
  Rig rig;
  std::optional<Covariance> covariance;           ///< what is sampled
  std::optional<Eigen::MatrixXd> covariance_mvb;  ///< the minimum variance bound beside it
  std::optional<CalibrationSummary> calibration;
  std::optional<CalibrationEvidence> evidence;
  std::string other_keys;  ///< keys of the file that this version does not know, as JSON text
};

/// The covariance to sample from. Throws Error(`place`) where the estimate has none.
const Covariance& required_covariance(const RigEstimate& estimate, const std::string& place);

/// One flag a parameter of the rig that was held: those that the calibration says, and those
/// without a variance. A component of a rotation has its variance as one of the rotation vector.
/// Where the estimate has no covariance none is. A rig file lists the others.
std::vector<bool> held_parameters(const RigEstimate& estimate);

/// The covariance over the parameters that are not held. Throws Error(`place`) where there is
/// none.
GaussianRigPrior gaussian_prior_of(const RigEstimate& estimate, const std::string& place);

/// Names the cameras otherwise, one name a camera, wherever the estimate says them: the
/// covariance and the held parameters too. Throws Error where they are too few or many, or not
/// different.
void rename_cameras(RigEstimate& estimate, const std::vector<std::string>& names);

/// Which of an estimate's two covariances is meant: the honest one (what is sampled) or the
/// minimum variance bound (what mrcal reports).
enum class CovarianceChoice { honest, mvb };

/// honest is the estimate's `covariance`, mvb its `covariance_mvb` (or the former where that is
/// of kind mvb); nothing where it has no such.
std::optional<Covariance> chosen_covariance(const RigEstimate& estimate, CovarianceChoice choice);

/// The same; throws Error(`place`) where it has no such.
Covariance required_covariance(const RigEstimate& estimate,
                               CovarianceChoice choice,
                               const std::string& place);

}  // namespace vernier
