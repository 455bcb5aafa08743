// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>

#include "calib/rig.h"

namespace vernier::test {

/// Largest difference of a parameter in its standard deviations by `C`, held parameters apart.
inline double worst_sigmas(const Rig& a, const Rig& b, const Eigen::MatrixXd& C) {
  const Eigen::VectorXd d = difference(a, b);
  double worst = 0;
  for (Eigen::Index i = 0; i < d.size(); ++i) {
    if (C(i, i) > 0) worst = std::max(worst, std::abs(d[i]) / std::sqrt(C(i, i)));
  }
  return worst;
}

}  // namespace vernier::test
