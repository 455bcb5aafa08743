// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "calib/calibration/small_sample_covariance.h"
#include "calib/covariance.h"
#include "calib/solver/normal_equations.h"

namespace vernier::internal {

/// Covariance for real images, where residuals of one frame (or image pair) are correlated: the
/// clustered sandwich with at least three clusters per parameter, its small-sample form
/// (calib/calibration/small_sample_covariance.h, kind jackknife) with fewer. `bound` is the inverse
/// of the equations' information. Throws Error for fewer than three clusters.
Covariance cluster_robust_covariance(const ReducedNormalEquations& equations,
                                     const Eigen::MatrixXd& bound,
                                     const std::vector<std::string>& names,
                                     BoundOf bound_of = BoundOf::white_noise);

}  // namespace vernier::internal
