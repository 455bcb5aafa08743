// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>

namespace vernier::internal {

// Decompositions of dense matrices of any size, compiled once. Eigen's templates cost several
// seconds in every source file that names them.

/// Eigenvalues, ascending, and unit eigenvectors of a symmetric matrix, of which the lower triangle
/// is read (Eigen::SelfAdjointEigenSolver).
class SymmetricEigen {
 public:
  explicit SymmetricEigen(const Eigen::MatrixXd& A);

  const Eigen::VectorXd& eigenvalues() const { return values_; }
  const Eigen::MatrixXd& eigenvectors() const { return vectors_; }
  /// The symmetric root A^(1/2), and A^(-1/2), of a positive (semi-)definite matrix.
  Eigen::MatrixXd root() const;
  Eigen::MatrixXd inverse_root() const;

 private:
  Eigen::VectorXd values_;
  Eigen::MatrixXd vectors_;
};

/// The eigenvalues alone, which is faster; their last digits may differ from SymmetricEigen's.
Eigen::VectorXd symmetric_eigenvalues(const Eigen::MatrixXd& A);

/// Cholesky decomposition A = L Lᵀ of a symmetric positive definite matrix (Eigen::LLT).
class Cholesky {
 public:
  explicit Cholesky(const Eigen::MatrixXd& A);

  /// Whether the decomposition succeeded; if not, nothing below is to be used.
  bool is_positive_definite() const { return factor_.info() == Eigen::Success; }
  /// Estimate of the reciprocal condition number.
  double rcond() const;
  Eigen::MatrixXd lower() const;

  Eigen::VectorXd solve(const Eigen::VectorXd& b) const;  ///< A⁻¹ b
  Eigen::MatrixXd solve(const Eigen::MatrixXd& B) const;
  Eigen::VectorXd solve_lower(const Eigen::VectorXd& b) const;  ///< L⁻¹ b
  Eigen::MatrixXd solve_lower(const Eigen::MatrixXd& B) const;
  Eigen::VectorXd solve_upper(const Eigen::VectorXd& b) const;  ///< L⁻ᵀ b
  Eigen::MatrixXd times_inverse_upper(const Eigen::MatrixXd& B) const;  ///< B L⁻ᵀ
  Eigen::MatrixXd inverse() const;

 private:
  Eigen::LLT<Eigen::MatrixXd> factor_;
};

/// A⁻¹ b by the pivoted decomposition L D Lᵀ, which stands a singular or slightly indefinite
/// symmetric A (Eigen::LDLT).
Eigen::VectorXd solve_symmetric(const Eigen::MatrixXd& A, const Eigen::VectorXd& b);
Eigen::MatrixXd solve_symmetric(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B);

/// An orthonormal basis of the columns of X, which must be independent (Eigen::HouseholderQR).
Eigen::MatrixXd orthonormal_basis(const Eigen::MatrixXd& X);

}  // namespace vernier::internal
