// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/calibration/small_sample_covariance.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "calib/base/decompositions.h"
#include "calib/error.h"
#include "calib/solver/normal_equations.h"

namespace vernier::internal {
namespace {

/// (I − H)^(-1/2) x for a symmetric H with eigenvalues in [0, 1). A view that alone determines a
/// direction (eigenvalue 1) has no residual along it; its eigenvalue is limited to just below 1.
Eigen::VectorXd correct_for_leverage(const Eigen::MatrixXd& H, const Eigen::VectorXd& x) {
  const SymmetricEigen eigen(0.5 * (H + H.transpose()));
  const Eigen::ArrayXd h = eigen.eigenvalues().array().max(0.0).min(0.999);
  const Eigen::MatrixXd& V = eigen.eigenvectors();
  return V * ((1 - h).rsqrt() * (V.transpose() * x).array()).matrix();
}

/// Ledoit and Wolf's shrinkage intensity of J = Σ x_f x_fᵀ towards the target.
double shrinkage_intensity(const Eigen::MatrixXd& pulls,
                           const Eigen::MatrixXd& J,
                           const Eigen::MatrixXd& target) {
  const auto n = static_cast<double>(pulls.cols());
  const double spread = (J - target).squaredNorm();
  if (!(spread > 0)) return 1;
  double scatter = 0;
  for (Eigen::Index f = 0; f < pulls.cols(); ++f) {
    scatter += (n * pulls.col(f) * pulls.col(f).transpose() - J).squaredNorm();
  }
  return std::min(1.0, scatter / (n * n) / spread);
}

}  // namespace

SmallSampleCovariance small_sample_covariance(const ReducedNormalEquations& equations,
                                              const Eigen::MatrixXd& bound,
                                              BoundOf bound_of) {
  const auto p = bound.rows();
  const auto frames = static_cast<Eigen::Index>(equations.frame_information.size());
  if (frames < 3) {
    throw Error("small-sample covariance", "fewer than three frames", "give more views");
  }
  const Eigen::MatrixXd L = Cholesky(bound).lower();
  Eigen::MatrixXd pulls(p, frames);
  for (Eigen::Index f = 0; f < frames; ++f) {
    const Eigen::MatrixXd H = L.transpose() * equations.frame_information[f] * L;
    pulls.col(f) = correct_for_leverage(H, L.transpose() * equations.scores.col(f));
  }
  Eigen::MatrixXd prior_share = Eigen::MatrixXd::Zero(p, p);
  if (equations.prior_information.size() > 0) {
    prior_share = L.transpose() * equations.prior_information * L;
    pulls.colwise() -= pulls.rowwise().mean().eval();  // their sum is the prior's pull, no scatter
  }
  const Eigen::MatrixXd data_share = Eigen::MatrixXd::Identity(p, p) - prior_share;
  const Eigen::MatrixXd J = pulls * pulls.transpose();
  SmallSampleCovariance result;
  result.inflation = J.trace() / std::max(data_share.trace(), 1e-9);
  const bool effects = bound_of == BoundOf::random_effects;
  if (effects) result.inflation = std::max(1.0, result.inflation);
  const Eigen::MatrixXd target = result.inflation * data_share;
  result.shrinkage = effects ? 1 : shrinkage_intensity(pulls, J, target);
  const Eigen::MatrixXd shrunk =
      (1 - result.shrinkage) * J + result.shrinkage * target + prior_share;
  result.matrix = L * shrunk * L.transpose();
  result.matrix = 0.5 * (result.matrix + result.matrix.transpose()).eval();
  return result;
}

}  // namespace vernier::internal
