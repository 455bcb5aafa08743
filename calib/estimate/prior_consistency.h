// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "calib/data_and_prior.h"

namespace vernier::internal {

/// The covariances that are compared, all over the same directions.
struct PriorAndEstimate {
  Eigen::MatrixXd prior;   ///< C_0 below
  Eigen::MatrixXd bound;   ///< C_mvb, of the estimate
  Eigen::MatrixXd honest;  ///< C, of the estimate
};

struct PriorConsistencyOptions {
  int clusters = 0;      ///< of data, used to estimate the scatter; 0: it is known
  double looseness = 1;  ///< of the estimate's prior, times the prior's standard deviations
};

/// With δ the estimate's offset from the prior's mean, C_0 the prior's covariance, C_mvb the bound
/// and C the honest covariance of the estimate, all over the same directions, the offset of a
/// right prior and right data has the covariance
///
///     D = C_mvb (B + H C_0 H) C_mvb,   H = C_mvb⁻¹ − C_0⁻¹,
///     C_mvb B C_mvb = C − C_mvb C_0⁻¹ C_mvb
///
/// (the estimate is the prior's mean moved by C_mvb times the score of the data there, whose noise
/// has the scatter B). χ² is of δ over the eigenvectors of C_0^(-1/2) D C_0^(-1/2) with eigenvalues
/// above 0.05, the directions the data inform. If B was estimated from `clusters` of data
/// (0: it is known; at least 2), χ² over its degrees of freedom is referred to Fisher's F with the
/// ν of their scatter below (calib/statistics/scatter_dof.h), after C's factor ν / (ν − 2) is taken
/// out of it. Bar-Shalom, Li and Kirubarajan, "Estimation
/// with Applications to Tracking and Navigation" (2001), section 5.4, has it for white noise as the
/// normalised innovation squared. The estimate
/// may have been made with the prior `looseness` times as wide, so that a wrong one does not hold
/// the rig away from the data: then H = C_mvb⁻¹ − C_0⁻¹ / looseness², and likewise in the last
/// equation. Throws Error if C_0 is singular.
PriorConsistency prior_consistency(const Eigen::VectorXd& offset,
                                   const std::vector<std::string>& names,
                                   const PriorAndEstimate& covariance,
                                   const PriorConsistencyOptions& options = {});

}  // namespace vernier::internal
