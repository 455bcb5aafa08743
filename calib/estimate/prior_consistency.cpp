// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/estimate/prior_consistency.h"

#include <Eigen/Geometry>
#include <cmath>

#include "calib/base/decompositions.h"
#include "calib/covariance.h"
#include "calib/data_and_prior.h"
#include "calib/error.h"
#include "calib/statistics/distributions.h"
#include "calib/statistics/scatter_dof.h"

namespace vernier::internal {

PriorConsistency prior_consistency(const Eigen::VectorXd& offset,
                                   const std::vector<std::string>& names,
                                   const PriorAndEstimate& covariance,
                                   const PriorConsistencyOptions& options) {
  const auto& [prior, bound, honest] = covariance;
  const auto [clusters, looseness] = options;
  constexpr double min_share = 0.05;
  const Eigen::VectorXd sd = prior.diagonal().cwiseSqrt();
  const auto scaled = [&](const Eigen::MatrixXd& C) -> Eigen::MatrixXd {
    const Eigen::MatrixXd R = sd.cwiseInverse().asDiagonal() * C * sd.cwiseInverse().asDiagonal();
    return 0.5 * (R + R.transpose());
  };
  const SymmetricEigen before(scaled(prior));
  const auto n = offset.size();
  if (!(before.eigenvalues()[0] > 1e-13 * before.eigenvalues()[n - 1])) {
    throw Error("prior",
                "its covariance is singular along " +
                    describe_direction(before.eigenvectors().col(0), names),
                "fix parameters that are known exactly");
  }
  // In the prior's own standard deviations, where C_0 = I.
  const Eigen::MatrixXd root = before.root(), inverse_root = before.inverse_root();
  const Eigen::MatrixXd C = inverse_root * scaled(bound) * inverse_root;
  const double p = 1 / (looseness * looseness);  // information of the prior that was used
  const Eigen::MatrixXd noise = inverse_root * scaled(honest) * inverse_root - p * C * C;
  const Eigen::MatrixXd moved = Eigen::MatrixXd::Identity(n, n) - p * C;  // C H
  const Eigen::MatrixXd D = noise + moved * moved.transpose();
  const Eigen::VectorXd delta = inverse_root * sd.cwiseInverse().asDiagonal() * offset;
  const SymmetricEigen eigen(0.5 * (D + D.transpose()));
  PriorConsistency agreement;
  for (Eigen::Index i = 0; i < n; ++i) {
    const double variance = eigen.eigenvalues()[i];
    if (variance < min_share) continue;
    const double z = eigen.eigenvectors().col(i).dot(delta) / std::sqrt(variance);
    agreement.chi2 += z * z;
    ++agreement.dof;
    if (std::abs(z) <= agreement.in_sigma) continue;
    agreement.in_sigma = std::abs(z);
    agreement.description =
        describe_direction((root * eigen.eigenvectors().col(i)).normalized(), names);
  }
  agreement.clusters = clusters;
  if (agreement.dof > 0) {
    const double nu = scatter_dof(clusters);
    agreement.p_value = clusters > 1
                            ? fisher_survival(student_variance(nu) * agreement.chi2 / agreement.dof,
                                              agreement.dof, nu)
                            : chi_squared_survival(agreement.chi2, agreement.dof);
  }
  return agreement;
}

}  // namespace vernier::internal
