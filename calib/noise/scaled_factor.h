// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <string>

#include "calib/base/decompositions.h"

namespace vernier::internal {

/// Cholesky factor of a symmetric matrix S = L Lᵀ, its unknowns scaled to a unit diagonal.
class ScaledFactor {
 public:
  /// Throws Error, saying that `what` is not determined, unless S is positive definite.
  ScaledFactor(const Eigen::MatrixXd& S, const std::string& what);

  double log_determinant() const;
  Eigen::VectorXd solve(const Eigen::VectorXd& b) const;
  Eigen::MatrixXd solve(const Eigen::MatrixXd& B) const;
  Eigen::MatrixXd inverse() const;
  Eigen::MatrixXd times_inverse_upper(const Eigen::MatrixXd& X) const;  ///< X L⁻ᵀ

 private:
  Eigen::VectorXd scale_;
  Cholesky factor_;
};

}  // namespace vernier::internal
