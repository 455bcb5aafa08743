// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "calib/statistics/random.h"

namespace vernier::test {

using namespace vernier::internal;

/// Quantile of the chi-squared distribution by Wilson and Hilferty's cube (error below 0.1 % for
/// ten degrees of freedom and more).
inline double chi_squared_quantile(double dof, double p) {
  const double a = 2 / (9 * dof);
  return dof * std::pow(1 - a + normal_quantile(p) * std::sqrt(a), 3);
}

}  // namespace vernier::test
