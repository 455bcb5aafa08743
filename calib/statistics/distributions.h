// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <vector>

#include "calib/statistics/random.h"

namespace vernier::internal {

/// Distribution function of χ² with `dof` degrees of freedom (calib/statistics/chi_squared.h).
double chi_squared_cdf(double x, double dof);

/// Its inverse, by Newton's method from Wilson and Hilferty's cube. p in (0, 1).
double chi_squared_quantile(double p, double dof);

/// Distribution function of the standard normal.
double normal_cdf(double z);

/// Probability that a sample from a distribution lies as far from its distribution function as
/// `sample` does from `cdf` (Kolmogorov's limit with Stephens' correction for n >= 4).
double kolmogorov_smirnov_p(std::vector<double> sample, const std::function<double(double)>& cdf);

/// A draw from χ² with `dof` > 2 degrees of freedom (Marsaglia and Tsang 2000).
double draw_chi_squared(RandomStream& draws, double dof);

}  // namespace vernier::internal
