// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace vernier::test {

// Eigen's own decompositions of dense matrices, for what a test compares with, compiled once: in
// every test that names them they cost ten seconds and more. Symmetric ones are in
// calib/base/decompositions.h.

/// A⁻¹ by the LU decomposition with partial pivots (Eigen::MatrixXd::inverse).
Eigen::MatrixXd inverse(const Eigen::MatrixXd& A);

/// All of Q of A = Q R (Eigen::HouseholderQR): the first columns span those of A.
Eigen::MatrixXd full_q(const Eigen::MatrixXd& A);

/// The x of least |A x - b| (Eigen::ColPivHouseholderQR).
Eigen::VectorXd least_squares(const Eigen::MatrixXd& A, const Eigen::VectorXd& b);

}  // namespace vernier::test
