// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace vernier::internal {

/// A positive semi-definite matrix scaled to a unit diagonal and decomposed,
///
///     D⁻¹ A D⁻¹ = U diag(s) Uᵀ,   D² = diag A
///
/// which is also its singular value decomposition. Rows with a diagonal not above 0 are ignored.
struct ScaledEigen {
  Eigen::VectorXd deviations;  ///< D
  Eigen::VectorXd values;      ///< s, largest first; equal ones in the order of the rows
  Eigen::MatrixXd directions;  ///< U

  explicit ScaledEigen(const Eigen::MatrixXd& matrix);
};

/// A root of A and its pseudo-inverse over the q directions with s above 1e-12 of the largest:
///
///     A = root rootᵀ,   white root = I
struct ScaledRoot {
  Eigen::MatrixXd root;   ///< D U √s, n x q
  Eigen::MatrixXd white;  ///< √s⁻¹ Uᵀ D⁻¹, q x n

  explicit ScaledRoot(const Eigen::MatrixXd& matrix);
};

}  // namespace vernier::internal
