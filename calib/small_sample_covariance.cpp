// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/small_sample_covariance.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "calib/error.h"

namespace vernier {
namespace {

/// (I − H)^(-1/2) x for a symmetric H with eigenvalues in [0, 1). A view that alone decides a
/// direction (eigenvalue 1) has no residual along it; it is held just below.
Eigen::VectorXd correct_for_leverage(const Eigen::MatrixXd& H, const Eigen::VectorXd& x) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(0.5 * (H + H.transpose()));
  const Eigen::ArrayXd h = eigen.eigenvalues().array().max(0.0).min(0.999);
  const Eigen::MatrixXd& V = eigen.eigenvectors();
  return V * ((1 - h).rsqrt() * (V.transpose() * x).array()).matrix();
}

/// Ledoit and Wolf's intensity for shrinking J = mean of x_f x_fᵀ towards a multiple of I.
double shrinkage_intensity(const Eigen::MatrixXd& pulls, const Eigen::MatrixXd& J, double mean) {
  const auto n = static_cast<double>(pulls.cols());
  const Eigen::MatrixXd target = mean * Eigen::MatrixXd::Identity(J.rows(), J.cols());
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
                                              const Eigen::MatrixXd& bound) {
  const auto p = bound.rows();
  const auto frames = static_cast<Eigen::Index>(equations.frame_information.size());
  if (frames < 3) {
    throw Error("small-sample covariance", "fewer than three frames", "give more views");
  }
  const Eigen::MatrixXd L = Eigen::LLT<Eigen::MatrixXd>(bound).matrixL();
  Eigen::MatrixXd pulls(p, frames);
  for (Eigen::Index f = 0; f < frames; ++f) {
    const Eigen::MatrixXd H = L.transpose() * equations.frame_information[f] * L;
    pulls.col(f) = correct_for_leverage(H, L.transpose() * equations.scores.col(f));
  }
  const Eigen::MatrixXd J = pulls * pulls.transpose();
  const double mean = J.trace() / static_cast<double>(p);
  SmallSampleCovariance result;
  result.inflation = mean;
  result.shrinkage = shrinkage_intensity(pulls, J, mean);
  const Eigen::MatrixXd shrunk =
      (1 - result.shrinkage) * J + result.shrinkage * mean * Eigen::MatrixXd::Identity(p, p);
  result.matrix = L * shrunk * L.transpose();
  result.matrix = 0.5 * (result.matrix + result.matrix.transpose()).eval();
  return result;
}

}  // namespace vernier
