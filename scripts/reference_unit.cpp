// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
//
// What check_build_cost.py compiles to tell how fast a machine compiles. A change of it changes
// what every limit means.
#include <Eigen/Cholesky>
#include <string>

double reference_unit(const Eigen::MatrixXd& A, const Eigen::VectorXd& b) {
  return A.llt().solve(b).sum() + static_cast<double>(std::to_string(b.sum()).size());
}
