// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/statistics/distributions.h"

#include <algorithm>
#include <boost/math/distributions/beta.hpp>
#include <boost/math/distributions/binomial.hpp>
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/fisher_f.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <cstddef>
#include <exception>
#include <limits>
#include <stdexcept>
#include <string>

#include "calib/error.h"
#include "calib/statistics/random.h"

namespace vernier::internal {
namespace {

// Doubles throughout: long double would cost five times as much for no benefit.
using Policy = boost::math::policies::policy<boost::math::policies::promote_double<false>,
                                             boost::math::policies::promote_float<false>>;
using ChiSquared = boost::math::chi_squared_distribution<double, Policy>;
using Fisher = boost::math::fisher_f_distribution<double, Policy>;
using Student = boost::math::students_t_distribution<double, Policy>;
using Binomial = boost::math::binomial_distribution<double, Policy>;

constexpr double infinity = std::numeric_limits<double>::infinity();

void check_dof(const char* distribution, double dof) {
  if (!(dof > 0) || std::isinf(dof)) {
    throw Error(distribution, "its degrees of freedom are not a number above 0", "");
  }
}

void check_number(const char* distribution, double x) {
  if (std::isnan(x)) throw Error(distribution, "x is not a number", "");
}

void check_probability(const char* distribution, double p) {
  if (!(p > 0 && p < 1)) throw Error(distribution, "p is not between 0 and 1", "");
}

/// What Boost.Math finds, whose exceptions become an Error.
template <class Evaluate>
double found(const char* distribution, Evaluate evaluate) {
  try {
    return evaluate();
  } catch (const std::overflow_error&) {
    throw Error(distribution, "the value is larger than a double can be", "");
  } catch (const std::exception& error) {
    throw Error(distribution, std::string("the value was not found: ") + error.what(), "");
  }
}

/// Whether P(χ² <= x) is less than any double, where Boost.Math gives up: by Chernoff's bound
/// (x e / dof)^(dof / 2) e^(-x / 2), which holds below the mean.
bool is_below_smallest_double(double x, double dof) {
  return x < dof && 0.5 * dof * (1 + std::log(x / dof)) - 0.5 * x < -750;
}

void check_binomial(int trials, double probability) {
  if (trials < 0 || !(probability >= 0 && probability <= 1)) {
    throw Error("binomial distribution",
                "its trials are negative or its probability is not in [0, 1]", "");
  }
}

}  // namespace

double normal_cdf(double z) { return 0.5 * std::erfc(-z / std::sqrt(2.0)); }

double normal_survival(double z) { return 0.5 * std::erfc(z / std::sqrt(2.0)); }

double chi_squared_cdf(double x, double dof) {
  check_dof("chi-squared", dof);
  check_number("chi-squared", x);
  if (x <= 0 || is_below_smallest_double(x, dof)) return 0;
  return x == infinity ? 1 : found("chi-squared", [&] { return cdf(ChiSquared(dof), x); });
}

double chi_squared_survival(double x, double dof) {
  check_dof("chi-squared", dof);
  check_number("chi-squared", x);
  if (x <= 0 || is_below_smallest_double(x, dof)) return 1;
  if (x == infinity) return 0;
  return found("chi-squared", [&] { return cdf(complement(ChiSquared(dof), x)); });
}

double chi_squared_quantile(double p, double dof) {
  check_dof("chi-squared", dof);
  check_probability("chi-squared", p);
  return found("chi-squared", [&] { return boost::math::quantile(ChiSquared(dof), p); });
}

double fisher_cdf(double x, double d1, double d2) {
  check_dof("F distribution", d1);
  check_dof("F distribution", d2);
  check_number("F distribution", x);
  if (x <= 0) return 0;
  return x == infinity ? 1 : found("F distribution", [&] { return cdf(Fisher(d1, d2), x); });
}

double fisher_survival(double x, double d1, double d2) {
  check_dof("F distribution", d1);
  check_dof("F distribution", d2);
  check_number("F distribution", x);
  if (x <= 0) return 1;
  if (x == infinity) return 0;
  return found("F distribution", [&] { return cdf(complement(Fisher(d1, d2), x)); });
}

double student_cdf(double t, double dof) {
  check_dof("t distribution", dof);
  check_number("t distribution", t);
  return found("t distribution", [&] { return cdf(Student(dof), t); });
}

double student_survival(double t, double dof) { return student_cdf(-t, dof); }

double student_quantile(double p, double dof) {
  check_dof("t distribution", dof);
  check_probability("t distribution", p);
  return found("t distribution", [&] { return boost::math::quantile(Student(dof), p); });
}

double beta_quantile(double p, double a, double b) {
  check_dof("beta distribution", a);
  check_dof("beta distribution", b);
  check_probability("beta distribution", p);
  return found("beta distribution", [&] {
    return boost::math::quantile(boost::math::beta_distribution<double, Policy>(a, b), p);
  });
}

double binomial_cdf(int successes, int trials, double probability) {
  check_binomial(trials, probability);
  if (successes < 0) return 0;
  if (successes >= trials) return 1;
  return found("binomial distribution",
               [&] { return cdf(Binomial(trials, probability), successes); });
}

double binomial_survival(int successes, int trials, double probability) {
  check_binomial(trials, probability);
  if (successes < 0) return 1;
  if (successes >= trials) return 0;
  return found("binomial distribution",
               [&] { return cdf(complement(Binomial(trials, probability), successes)); });
}

double kolmogorov_smirnov_p(std::vector<double> sample, const std::function<double(double)>& cdf) {
  std::sort(sample.begin(), sample.end());
  const auto n = static_cast<double>(sample.size());
  double distance = 0;
  for (std::size_t i = 0; i < sample.size(); ++i) {
    const double F = cdf(sample[i]), below = static_cast<double>(i) / n;
    distance = std::max({distance, F - below, below + 1 / n - F});
  }
  const double root = std::sqrt(n), x = (root + 0.12 + 0.11 / root) * distance;
  if (x < 0.2) return 1;
  double p = 0;
  for (int k = 1; k < 100; ++k) p += (k % 2 ? 2 : -2) * std::exp(-2 * k * k * x * x);
  return std::clamp(p, 0.0, 1.0);
}

std::vector<double> holm_adjusted(const std::vector<double>& p) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < p.size(); ++i) {
    if (!std::isnan(p[i])) order.push_back(i);
  }
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return p[a] < p[b]; });
  std::vector<double> adjusted = p;
  double largest = 0;
  for (std::size_t k = 0; k < order.size(); ++k) {
    const double step = static_cast<double>(order.size() - k) * p[order[k]];
    largest = std::max(largest, std::min(1.0, step));
    adjusted[order[k]] = largest;
  }
  return adjusted;
}

double draw_chi_squared(RandomStream& draws, double dof) {
  const double d = 0.5 * dof - 1.0 / 3, c = 1 / std::sqrt(9 * d);
  for (;;) {
    const double z = draws.normal(), v = std::pow(1 + c * z, 3);
    if (v > 0 && std::log(draws.uniform()) < 0.5 * z * z + d - d * v + d * std::log(v)) {
      return 2 * d * v;
    }
  }
}

}  // namespace vernier::internal
