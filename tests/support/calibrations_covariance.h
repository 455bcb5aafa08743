// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "calib/covariance.h"
#include "calib/rig.h"

namespace vernier::test {

/// A covariance with standard deviations a calibration would have, correlated.
inline Covariance calibrations_covariance(const Rig& rig) {
  const int n = parameter_count(rig);
  Eigen::MatrixXd root(n, n);
  for (int i = 0; i < n; ++i) {
    const std::string name = parameter_names(rig)[i];
    const bool px = name.find("_px") != std::string::npos;
    for (int j = 0; j < n; ++j) root(i, j) = (px ? 0.3 : 5e-4) * std::sin(1.0 + 7 * i * n + 3 * j);
  }
  return {CovarianceKind::prior, parameter_names(rig), root * root.transpose()};
}

}  // namespace vernier::test
