// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/statistics/chi_squared.h"

#include <math.h>

#include <cmath>
#include <limits>

#include "calib/error.h"

namespace vernier::internal {
namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();

/// x^a e^-x / Γ(a). std::lgamma writes a global sign; lgamma_r does not.
double prefactor(double a, double x) {
  int sign = 0;
  return std::exp(a * std::log(x) - x - ::lgamma_r(a, &sign));
}

/// P(a, x) = prefactor Σ x^n / (a (a + 1) … (a + n)), Eq. 6.5.29.
double lower_by_series(double a, double x) {
  double term = 1 / a, sum = term;
  for (double n = 1; term > sum * epsilon; ++n) {
    term *= x / (a + n);
    sum += term;
  }
  return prefactor(a, x) * sum;
}

/// Q(a, x) = prefactor · 1/(x + 1 − a − 1 (1 − a)/(x + 3 − a − 2 (2 − a)/(x + 5 − a − …))), the
/// even part of Eq. 6.5.31, from the front by Lentz's recursion. The denominators stay positive for
/// x >= a + 1.
double upper_by_fraction(double a, double x) {
  double b = x + 1 - a;
  double ratio = std::numeric_limits<double>::max(), inverse = 1 / b, value = inverse;
  for (double n = 1;; ++n) {
    const double numerator = -n * (n - a);
    b += 2;
    inverse = 1 / (b + numerator * inverse);
    ratio = b + numerator / ratio;
    const double change = ratio * inverse;
    value *= change;
    if (!(std::abs(change - 1) > 2 * epsilon)) return prefactor(a, x) * value;
  }
}

/// Regularised incomplete beta function I_x(a, b).
double incomplete_beta(double x, double a, double b) {
  if (x <= 0) return 0;
  if (x >= 1) return 1;
  if (x > (a + 1) / (a + b + 2)) return 1 - incomplete_beta(1 - x, b, a);
  constexpr double tiny = 1e-300;
  double C = 1, D = 1 - (a + b) * x / (a + 1);
  D = 1 / (std::abs(D) < tiny ? tiny : D);
  double fraction = D;
  for (int m = 1; m < 10000; ++m) {
    const double even = m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m));
    const double odd = -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1));
    for (const double d : {even, odd}) {
      D = 1 + d * D;
      D = 1 / (std::abs(D) < tiny ? tiny : D);
      C = 1 + d / C;
      if (std::abs(C) < tiny) C = tiny;
      fraction *= C * D;
    }
    if (std::abs(C * D - 1) < 1e-15) break;
  }
  int sign = 0;
  const double log_beta = ::lgamma_r(a, &sign) + ::lgamma_r(b, &sign) - ::lgamma_r(a + b, &sign);
  return std::exp(a * std::log(x) + b * std::log1p(-x) - log_beta) * fraction / a;
}

}  // namespace

double chi_squared_survival(double x, double dof) {
  if (!(dof > 0) || std::isinf(dof)) {
    throw Error("chi-squared", "its degrees of freedom are not a number above 0", "");
  }
  if (std::isnan(x)) throw Error("chi-squared", "x is not a number", "");
  if (x <= 0) return 1;
  if (std::isinf(x)) return 0;
  const double a = 0.5 * dof, half = 0.5 * x;
  return half < a + 1 ? 1 - lower_by_series(a, half) : upper_by_fraction(a, half);
}

double fisher_survival(double x, double d1, double d2) {
  if (!(d1 > 0 && d2 > 0) || std::isnan(x)) {
    throw Error("F distribution", "its degrees of freedom must be above 0 and x a number", "");
  }
  if (x <= 0) return 1;
  if (std::isinf(x)) return 0;
  return incomplete_beta(d2 / (d2 + d1 * x), 0.5 * d2, 0.5 * d1);
}

}  // namespace vernier::internal
