// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <vector>

#include "calib/statistics/random.h"

namespace vernier::internal {

// Distributions, by Boost.Math. A cdf is P(X <= x), a survival function P(X > x), each computed
// directly and not as one minus the other, so that both tails keep their relative accuracy. All
// throw Error for degrees of freedom that are not positive and finite, a p outside (0, 1), an x
// that is NaN, and a result that overflows.

/// The standard normal. Its quantile is normal_quantile (calib/statistics/random.h).
double normal_cdf(double z);
double normal_survival(double z);
/// 95 % of a normal distribution lie within so many standard deviations.
inline constexpr double z_95 = 1.959963984540054;

/// χ² with `dof` degrees of freedom.
double chi_squared_cdf(double x, double dof);
double chi_squared_survival(double x, double dof);
double chi_squared_quantile(double p, double dof);

/// Fisher's F with d1 and d2 degrees of freedom.
double fisher_cdf(double x, double d1, double d2);
double fisher_survival(double x, double d1, double d2);

/// Student's t with `dof` degrees of freedom.
double student_cdf(double t, double dof);
double student_survival(double t, double dof);
double student_quantile(double p, double dof);

/// Quantile of the beta distribution.
double beta_quantile(double p, double a, double b);

/// Binomial: at most, and more than, `successes` of `trials`.
double binomial_cdf(int successes, int trials, double probability);
double binomial_survival(int successes, int trials, double probability);

/// p-value of the Kolmogorov–Smirnov test of `sample` against `cdf` (Kolmogorov's limit with
/// Stephens' correction for n >= 4).
double kolmogorov_smirnov_p(std::vector<double> sample, const std::function<double(double)>& cdf);

/// p-values adjusted for their number by Holm's step-down method (Holm 1979): a hypothesis with an
/// adjusted p below α may be rejected with a probability of at most α of any false rejection. One
/// that is not a number stays so and is not counted.
std::vector<double> holm_adjusted(const std::vector<double>& p);

/// A draw from χ² with `dof` > 2 degrees of freedom (Marsaglia and Tsang 2000).
double draw_chi_squared(RandomStream& draws, double dof);

}  // namespace vernier::internal
