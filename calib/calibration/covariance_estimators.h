// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "calib/solver/normal_equations.h"

namespace vernier::internal {

/// Minimum variance bound: the inverse of the reduced information, C = S⁻¹ (Tina Memo 2017-001, Eq.
/// 3), scaled before it is factored. Throws Error, naming the parameters along the direction, if
/// the information is singular (condition above 1e13 after scaling).
Eigen::MatrixXd minimum_variance_bound(const ReducedNormalEquations& equations,
                                       const std::vector<std::string>& names);

/// Sandwich clustered by frame, F/(F-1) C (Σ_f g_f g_fᵀ) C: valid if residuals within a view are
/// correlated (White 1980; Liang and Zeger 1986) and frames are many. Its rank is at most F - 1, so
/// Error is thrown unless F >= `frames_per_parameter` x parameters. A prior of information P adds C
/// P C.
Eigen::MatrixXd clustered_sandwich(const ReducedNormalEquations& equations,
                                   const Eigen::MatrixXd& bound,
                                   double frames_per_parameter = 3);

}  // namespace vernier::internal
