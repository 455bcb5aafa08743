// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace vernier::test {

/// The largest difference, relative to the largest element of `wanted`.
inline double relative_difference(const Eigen::MatrixXd& found, const Eigen::MatrixXd& wanted) {
  return (found - wanted).cwiseAbs().maxCoeff() / wanted.cwiseAbs().maxCoeff();
}

}  // namespace vernier::test
