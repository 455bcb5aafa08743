// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>

namespace vernier::internal {

// Decompositions of dense matrices of any size, compiled once. Eigen's templates cost several
// seconds in every source file that names them.

/// Eigenvalues (ascending) and unit eigenvectors of a symmetric matrix, of which only the lower
/// triangle is read (Eigen::SelfAdjointEigenSolver).
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

/// The same for the 9 x 9 matrices of the direct linear transform.
struct SymmetricEigen9 {
  Eigen::Matrix<double, 9, 1> eigenvalues;
  Eigen::Matrix<double, 9, 9> eigenvectors;

  explicit SymmetricEigen9(const Eigen::Matrix<double, 9, 9>& A);
};

/// Eigenvalues only. Faster; the last digits may differ from SymmetricEigen's.
Eigen::VectorXd symmetric_eigenvalues(const Eigen::MatrixXd& A);

/// Cholesky decomposition A = L Lᵀ of a symmetric positive definite matrix (Eigen::LLT).
class Cholesky {
 public:
  explicit Cholesky(const Eigen::MatrixXd& A);

  /// Whether the decomposition succeeded. If not, no other member is valid.
  bool is_positive_definite() const { return factor_.info() == Eigen::Success; }
  /// Estimate of the reciprocal condition number.
  double rcond() const;
  Eigen::MatrixXd lower() const;

  Eigen::VectorXd solve(const Eigen::VectorXd& b) const;  ///< A⁻¹ b
  Eigen::MatrixXd solve(const Eigen::MatrixXd& B) const;
  Eigen::VectorXd solve_lower(const Eigen::VectorXd& b) const;  ///< L⁻¹ b
  Eigen::MatrixXd solve_lower(const Eigen::MatrixXd& B) const;
  Eigen::VectorXd solve_upper(const Eigen::VectorXd& b) const;          ///< L⁻ᵀ b
  Eigen::MatrixXd times_inverse_upper(const Eigen::MatrixXd& B) const;  ///< B L⁻ᵀ
  Eigen::MatrixXd inverse() const;

 private:
  Eigen::LLT<Eigen::MatrixXd> factor_;
};

/// A⁻¹ b by the pivoted decomposition L D Lᵀ (Eigen::LDLT), which also handles a singular or
/// slightly indefinite symmetric A.
Eigen::VectorXd solve_symmetric(const Eigen::MatrixXd& A, const Eigen::VectorXd& b);
Eigen::MatrixXd solve_symmetric(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B);

/// The singular values of A, largest first, and all its right singular vectors (Eigen::JacobiSVD).
struct RightSingularVectors {
  Eigen::VectorXd singular_values;
  Eigen::MatrixXd V;

  explicit RightSingularVectors(const Eigen::MatrixXd& A);
};

/// The upper triangle R of A = Q R (Eigen::HouseholderQR). A has at least as many rows as columns.
Eigen::MatrixXd qr_triangle(const Eigen::MatrixXd& A);

/// An orthonormal basis of the columns of X, which must be linearly independent
/// (Eigen::HouseholderQR).
Eigen::MatrixXd orthonormal_basis(const Eigen::MatrixXd& X);

}  // namespace vernier::internal
