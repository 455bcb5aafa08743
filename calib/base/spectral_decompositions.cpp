// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Eigenvalues>
#include <Eigen/SVD>

#include "calib/base/decompositions.h"

namespace vernier::internal {

SymmetricEigen::SymmetricEigen(const Eigen::MatrixXd& A) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(A);
  values_ = eigen.eigenvalues();
  vectors_ = eigen.eigenvectors();
}

Eigen::MatrixXd SymmetricEigen::root() const {
  return vectors_ * values_.cwiseSqrt().asDiagonal() * vectors_.transpose();
}

Eigen::MatrixXd SymmetricEigen::inverse_root() const {
  return vectors_ * values_.cwiseInverse().cwiseSqrt().asDiagonal() * vectors_.transpose();
}

Eigen::VectorXd symmetric_eigenvalues(const Eigen::MatrixXd& A) {
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(A, Eigen::EigenvaluesOnly).eigenvalues();
}

SymmetricEigen9::SymmetricEigen9(const Eigen::Matrix<double, 9, 9>& A) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 9, 9>> eigen(A);
  eigenvalues = eigen.eigenvalues();
  eigenvectors = eigen.eigenvectors();
}

RightSingularVectors::RightSingularVectors(const Eigen::MatrixXd& A) {
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(A, Eigen::ComputeFullV);
  singular_values = svd.singularValues();
  V = svd.matrixV();
}

}  // namespace vernier::internal
