// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <functional>

namespace vernier::test {

/// Derivative of f at x by central differences of fourth order.
inline Eigen::MatrixXd numeric_jacobian(
    const std::function<Eigen::VectorXd(const Eigen::VectorXd&)>& f,
    const Eigen::VectorXd& x,
    double relative_step = 1e-4) {
  Eigen::MatrixXd J(f(x).size(), x.size());
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    const double h = relative_step * std::max(1.0, std::abs(x[i]));
    const auto at = [&](double step) {
      Eigen::VectorXd y = x;
      y[i] += step * h;
      return f(y);
    };
    J.col(i) = (8 * (at(1) - at(-1)) - (at(2) - at(-2))) / (12 * h);
  }
  return J;
}

}  // namespace vernier::test
