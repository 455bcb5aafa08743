// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calib/covariance.h"
#include "calib/rig.h"
#include "calib/rig_prior.h"

namespace vernier::internal {

/// Doubts about a calibration that its own result raises; nothing where there is none.

/// Condition of a scaled covariance (calib/covariance.h) beyond which what the views hardly
/// determine passes for known: residuals in double precision tell directions apart up to about
/// 1e13, and model errors far below the noise move such a direction as they like.
inline constexpr double largest_scaled_condition = 1e11;

/// Do the views determine the rig's free parameters? `bound` is over these.
std::optional<std::string> ill_conditioning_warning(const Covariance& bound, const Rig& rig);

/// Do data and prior contradict each other, at p < 1e-4 (calib/estimate/prior_consistency.h)?
/// `bound` and `honest` are over all parameters of the rig, zero where one is held; `clusters` as
/// there. Names the parameter that moved most in the prior's standard deviations.
std::optional<std::string> prior_conflict_warning(const RigPrior& prior,
                                                  const Rig& rig,
                                                  const Eigen::MatrixXd& bound,
                                                  const Eigen::MatrixXd& honest,
                                                  int clusters);

/// Does each pixel of each camera have a ray? One warning a camera whose distortion cannot be
/// inverted at some of 33 x 25 pixels spread over its image, with the region: the coefficients fold
/// the image where no corner kept them from it.
std::vector<std::string> inversion_warnings(const Rig& rig);

}  // namespace vernier::internal
