// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "calib/covariance.h"
#include "calib/rig.h"

namespace vernier::internal {

/// Throws Error (`place`) unless parameters of these names can have the covariance: a row and a
/// column for each, symmetric, and no direction with a negative variance (ScaledDecomposition).
void check_covariance(const Eigen::MatrixXd& matrix,
                      const std::vector<std::string>& names,
                      const std::string& place);

/// The same for all parameters of a rig.
void check_covariance(const Eigen::MatrixXd& matrix, const Rig& rig, const std::string& place);

/// Throws Error (`place`) unless a covariance's names are those of the rig's parameters, in order.
void check_names(const Covariance& covariance, const Rig& rig, const std::string& place);

}  // namespace vernier::internal
