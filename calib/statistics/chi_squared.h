// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace vernier::internal {

/// Probability that a chi-squared variable of `dof` degrees of freedom exceeds x,
///
///     P(χ² > x) = Q(dof / 2, x / 2),   Q(a, x) = Γ(a, x) / Γ(a)
///
/// the regularised upper incomplete gamma function: by its power series where x < a + 1 and by its
/// continued fraction (Lentz's recursion) elsewhere. Abramowitz and Stegun, Eqs. 6.5.29 and 6.5.31.
/// Relative accuracy about 1e-12 in the upper tail up to 1000 degrees of freedom. 1 for x <= 0, 0
/// for infinite x. Throws Error unless dof > 0 and x is a number.
double chi_squared_survival(double x, double dof);

/// Probability that a variable of Fisher's F distribution with d1 and d2 degrees of freedom exceeds
/// x, by the regularised incomplete beta function (continued fraction by Lentz's recursion;
/// Abramowitz and Stegun, Eqs. 26.5.8 and 26.6.2). Throws Error unless d1, d2 > 0 and x is a
/// number.
double fisher_survival(double x, double d1, double d2);

}  // namespace vernier::internal
