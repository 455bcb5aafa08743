// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/base/decompositions.h"

#include <Eigen/QR>
#include <utility>

namespace vernier::internal {

Cholesky::Cholesky(const Eigen::MatrixXd& A) : factor_(A) {}

double Cholesky::rcond() const { return factor_.rcond(); }

Eigen::MatrixXd Cholesky::lower() const { return factor_.matrixL(); }

Eigen::VectorXd Cholesky::solve(const Eigen::VectorXd& b) const { return factor_.solve(b); }

Eigen::MatrixXd Cholesky::solve(const Eigen::MatrixXd& B) const { return factor_.solve(B); }

Eigen::VectorXd Cholesky::solve_lower(const Eigen::VectorXd& b) const {
  return factor_.matrixL().solve(b);
}

Eigen::MatrixXd Cholesky::solve_lower(const Eigen::MatrixXd& B) const {
  return factor_.matrixL().solve(B);
}

Eigen::VectorXd Cholesky::solve_upper(const Eigen::VectorXd& b) const {
  return factor_.matrixU().solve(b);
}

Eigen::MatrixXd Cholesky::times_inverse_upper(const Eigen::MatrixXd& B) const {
  return factor_.matrixL().solve(B.transpose()).transpose();
}

Eigen::MatrixXd Cholesky::inverse() const {
  const auto n = factor_.rows();
  return solve(Eigen::MatrixXd(Eigen::MatrixXd::Identity(n, n)));
}

Eigen::VectorXd solve_symmetric(const Eigen::MatrixXd& A, const Eigen::VectorXd& b) {
  return Eigen::LDLT<Eigen::MatrixXd>(A).solve(b);
}

Eigen::MatrixXd solve_symmetric(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B) {
  return Eigen::LDLT<Eigen::MatrixXd>(A).solve(B);
}

Eigen::MatrixXd qr_triangle(const Eigen::MatrixXd& A) {
  const auto n = A.cols();
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(A);
  return qr.matrixQR().topRows(n).triangularView<Eigen::Upper>();
}

Eigen::MatrixXd orthonormal_basis(const Eigen::MatrixXd& X) {
  return Eigen::HouseholderQR<Eigen::MatrixXd>(X).householderQ() *
         Eigen::MatrixXd::Identity(X.rows(), X.cols());
}

}  // namespace vernier::internal
