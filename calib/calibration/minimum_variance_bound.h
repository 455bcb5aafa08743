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

}  // namespace vernier::internal
