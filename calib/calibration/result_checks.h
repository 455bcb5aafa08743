// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calib/calibration/residual_diagnosis.h"
#include "calib/covariance.h"
#include "calib/rig.h"
#include "calib/rig_prior.h"

namespace vernier::internal {

/// Residuals of corners whose rms is smaller are not noise: the corners are exact.
inline constexpr double exact_corners_px = 1e-3;

/// Trust warnings derived from the result of a calibration; std::nullopt or empty if there is none.

/// Scaled condition number of a covariance (calib/covariance.h) above which undetermined directions
/// appear to be determined: residuals in double precision distinguish directions up to about 1e13,
/// and model errors far below the noise move such directions arbitrarily.
inline constexpr double largest_scaled_condition = 1e11;

/// Checks that the views determine the rig's free parameters. `bound` is over these.
std::optional<std::string> ill_conditioning_warning(const Covariance& bound, const Rig& rig);

/// Checks that neither what is held nor the data contradicts the prior, at p < 1e-4; data by
/// calib/estimate/prior_consistency.h. `bound` and `honest` are over all parameters of the rig,
/// zero for held ones; `clusters` as there. Names the parameter that moved most in the prior's
/// standard deviations.
std::optional<std::string> prior_conflict_warning(const RigPrior& prior,
                                                  const Rig& rig,
                                                  const Eigen::MatrixXd& bound,
                                                  const Eigen::MatrixXd& honest,
                                                  int clusters);

/// Checks the stated noise of a pixel coordinate against the residuals, by χ² over its degrees of
/// freedom. Beyond 3² or below 1/3² (and not by chance, p < 1e-4) the stated noise is not that of
/// the corners: standard deviations from it are wrong by more than a factor of three. The limits do
/// not depend on the number of corners, since lens and board models of real sets are off by a share
/// of the noise, which many corners would show. Residuals below 0.001 px are of computed corners,
/// which have no noise to doubt.
std::optional<std::string> noise_warning(double chi2, double dof, double pixel_sigma_px);

/// The trust warning for residuals larger than corner noise, with what was found of their causes
/// (calib/calibration/residual_diagnosis.h).
std::string residual_warning(double rms_px, const std::vector<ResidualFinding>& findings);

/// Checks that each pixel of each camera has a ray. One warning, with the region, per camera whose
/// distortion cannot be inverted at some of 33 x 25 pixels spread over its image: the coefficients
/// fold the image where no corner constrains them, or, if that is all, the lens sees further than
/// its model goes.
std::vector<std::string> inversion_warnings(const Rig& rig);

}  // namespace vernier::internal
