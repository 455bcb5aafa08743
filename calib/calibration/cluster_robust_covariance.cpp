// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/calibration/cluster_robust_covariance.h"

#include <string>
#include <vector>

#include "calib/calibration/covariance_estimators.h"
#include "calib/calibration/small_sample_covariance.h"
#include "calib/covariance.h"
#include "calib/solver/normal_equations.h"

namespace vernier::internal {

Covariance cluster_robust_covariance(const ReducedNormalEquations& equations,
                                     const Eigen::MatrixXd& bound,
                                     const std::vector<std::string>& names,
                                     BoundOf bound_of) {
  constexpr double frames_per_parameter = 3;
  const auto frames = static_cast<double>(equations.scores.cols());
  if (frames >= frames_per_parameter * static_cast<double>(names.size())) {
    return {CovarianceKind::clustered, names,
            clustered_sandwich(equations, bound, frames_per_parameter)};
  }
  return {CovarianceKind::jackknife, names, small_sample_covariance(equations, bound, bound_of)};
}

}  // namespace vernier::internal
