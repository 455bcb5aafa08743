// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/statistics/distributions.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "calib/interval.h"
#include "tests/support/error_message.h"

namespace vernier {

using namespace vernier::internal;

namespace {

double relative(double value, double expected) { return std::abs(value / expected - 1); }

TEST(ChiSquared, HasItsClosedFormForOneAndTwoDegreesOfFreedom) {
  for (const double x : {1e-6, 0.01, 0.5, 1.0, 2.9, 3.1, 10.0, 50.0, 300.0, 1200.0}) {
    EXPECT_LT(relative(chi_squared_survival(x, 1), std::erfc(std::sqrt(x / 2))), 1e-11) << x;
    EXPECT_LT(relative(chi_squared_survival(x, 2), std::exp(-x / 2)), 1e-12) << x;
  }
}

// An even number 2m of degrees of freedom is m Poisson terms (Abramowitz and Stegun 26.4.21).
TEST(ChiSquared, IsAPoissonSumForEvenDegreesOfFreedom) {
  for (const int m : {4, 8, 50, 400}) {
    for (const double share : {0.3, 0.8, 1.0, 1.2, 1.6}) {
      const double half = share * m;
      double term = std::exp(-half), sum = 0;
      for (int j = 0; j < m; ++j, term *= half / j) sum += term;
      EXPECT_LT(relative(chi_squared_survival(2 * half, 2 * m), sum), 1e-11) << m << ' ' << share;
    }
  }
}

// Percentage points of published tables: Abramowitz and Stegun, Table 26.8.
TEST(ChiSquared, MeetsTheTables) {
  EXPECT_NEAR(chi_squared_survival(3.84146, 1), 0.05, 1e-6);
  EXPECT_NEAR(chi_squared_survival(15.0863, 5), 0.01, 1e-6);
  EXPECT_NEAR(chi_squared_survival(18.3070, 10), 0.05, 1e-6);
  EXPECT_NEAR(chi_squared_survival(13.7867, 30), 0.995, 1e-6);
  EXPECT_NEAR(chi_squared_survival(124.342, 100), 0.05, 1e-6);
}

TEST(ChiSquared, EndsAtOneAndAtZero) {
  EXPECT_EQ(chi_squared_survival(0, 16), 1);
  EXPECT_EQ(chi_squared_survival(-1, 16), 1);
  EXPECT_EQ(chi_squared_survival(std::numeric_limits<double>::infinity(), 16), 0);
  // residuals of exact data
  for (const double x : {1e-300, 1e-12, 1.0}) {
    EXPECT_EQ(chi_squared_cdf(x, 4000), 0) << x;
    EXPECT_EQ(chi_squared_survival(x, 4000), 1) << x;
  }
}

TEST(ChiSquared, RefusesWhatIsNoNumber) {
  EXPECT_NE(test::error_message([] { chi_squared_survival(1, 0); }).find("degrees of freedom"),
            std::string::npos);
  EXPECT_NE(test::error_message([] { chi_squared_survival(std::nan(""), 3); }).find("not a number"),
            std::string::npos);
}

// Boost.Math's own exceptions are none that a caller of this library expects.
TEST(Distributions, RefuseEveryArgumentThatIsNoneWithAnError) {
  constexpr double inf = std::numeric_limits<double>::infinity(), nan = NAN;
  using Call = std::function<double()>;
  for (const double bad : {inf, nan, 0.0, -1.0}) {
    const Call calls[] = {
        [&] { return fisher_survival(1, 3, bad); }, [&] { return fisher_survival(1, bad, 3); },
        [&] { return fisher_cdf(1, 3, bad); },      [&] { return fisher_cdf(1, bad, 3); },
        [&] { return beta_quantile(0.5, 3, bad); }, [&] { return beta_quantile(0.5, bad, 3); },
        [&] { return student_cdf(1, bad); },        [&] { return student_quantile(0.5, bad); }};
    for (const Call& call : calls) {
      EXPECT_NE(test::error_message(call).find("degrees of freedom"), std::string::npos) << bad;
    }
  }
  EXPECT_NE(test::error_message([] { student_quantile(1e-300, 0.5); }).find("larger than a double"),
            std::string::npos);
  EXPECT_EQ(student_cdf(inf, 3), 1);
  EXPECT_EQ(student_survival(inf, 3), 0);
}

TEST(Fisher, SurvivalIsThatOfTheTables) {
  // Upper 5 % and 1 % points (Pearson and Hartley, Biometrika Tables, Table 18).
  EXPECT_NEAR(fisher_survival(4.9646, 1, 10), 0.05, 2e-6);
  EXPECT_NEAR(fisher_survival(3.3258, 5, 10), 0.05, 1e-5);
  EXPECT_NEAR(fisher_survival(5.6363, 5, 10), 0.01, 1e-5);
  EXPECT_NEAR(fisher_survival(2.2033, 15, 20), 0.05, 1e-5);
  // An F of one degree above is Student's t squared; of many below, χ².
  EXPECT_NEAR(fisher_survival(2.0 * 2.0, 1, 1), 2 * (0.5 - std::atan(2.0) / std::acos(-1.0)),
              1e-12);
  EXPECT_NEAR(fisher_survival(1.5, 12, 1e7), chi_squared_survival(18, 12), 1e-6);
  EXPECT_EQ(fisher_survival(0, 3, 4), 1);
  EXPECT_EQ(fisher_survival(std::numeric_limits<double>::infinity(), 3, 4), 0);
}

// Upper percentage points (Pearson and Hartley, Biometrika Tables, Table 12).
TEST(Student, MeetsTheTables) {
  EXPECT_NEAR(student_quantile(0.975, 1), 12.706, 5e-4);
  EXPECT_NEAR(student_quantile(0.975, 3), 3.182, 5e-4);
  EXPECT_NEAR(student_quantile(0.995, 5), 4.032, 5e-4);
  EXPECT_NEAR(student_quantile(0.975, 30), 2.042, 5e-4);
  EXPECT_NEAR(student_survival(2.228, 10), 0.025, 1e-5);
}

// Far out each tail must be right by itself: one less the other would be 0 there.
TEST(Tails, KeepTheirRelativeAccuracy) {
  EXPECT_LT(relative(chi_squared_survival(400, 2), std::exp(-200.0)), 1e-10);
  EXPECT_LT(relative(chi_squared_cdf(1e-20, 2), 0.5e-20), 1e-10);
  EXPECT_LT(relative(normal_survival(30), 4.906713927148187e-198), 1e-10);
  EXPECT_LT(relative(normal_cdf(-30), normal_survival(30)), 1e-14);
  // t with one degree of freedom is Cauchy's: P(T > x) = atan(1 / x) / π
  EXPECT_LT(relative(student_survival(1e8, 1), std::atan(1e-8) / std::acos(-1.0)), 1e-10);
  EXPECT_LT(relative(binomial_survival(29, 30, 0.01), 1e-60), 1e-10);
  EXPECT_LT(relative(fisher_survival(1e6, 2, 2), 1 / (1 + 1e6)), 1e-10);
}

TEST(Binomial, IsTheSumOfItsTerms) {
  double sum = 0, term = std::pow(0.7, 12);
  for (int k = 0; k <= 12; ++k) {
    sum += term;
    EXPECT_NEAR(binomial_cdf(k, 12, 0.3), sum, 1e-13) << k;
    EXPECT_NEAR(binomial_survival(k, 12, 0.3), 1 - sum, 1e-13) << k;
    term *= (12.0 - k) / (k + 1) * 0.3 / 0.7;
  }
}

TEST(Quantiles, InvertTheirDistributions) {
  for (const double p : {1e-6, 0.01, 0.5, 0.99}) {
    for (const double dof : {1.0, 3.0, 40.0}) {
      EXPECT_NEAR(chi_squared_cdf(chi_squared_quantile(p, dof), dof), p, 1e-12);
      EXPECT_NEAR(student_cdf(student_quantile(p, dof), dof), p, 1e-12);
    }
  }
}

// Each limit is the proportion at which what was seen, or more extreme, has the tail's probability.
TEST(ClopperPearson, LimitsHaveTheTailsOfTheBinomial) {
  for (const auto& [k, n] : {std::pair{3, 20}, {19, 20}, {450, 900}}) {
    const Interval interval = clopper_pearson_interval(k, n);
    EXPECT_NEAR(binomial_survival(k - 1, n, interval.low), 0.025, 1e-10);
    EXPECT_NEAR(binomial_cdf(k, n, interval.high), 0.025, 1e-10);
  }
  EXPECT_EQ(clopper_pearson_interval(0, 10).low, 0);
  EXPECT_NEAR(clopper_pearson_interval(0, 10).high, 1 - std::pow(0.025, 0.1), 1e-12);
  EXPECT_EQ(clopper_pearson_interval(10, 10).high, 1);
  EXPECT_NE(
      test::error_message([] { clopper_pearson_interval(11, 10); }).find("11 successes of 10"),
      std::string::npos);
}

// Wright, "Adjusted p-values for simultaneous inference" (1992), has the rule.
TEST(Holm, StepsDownAndNeverDecreases) {
  const std::vector<double> adjusted = holm_adjusted({0.01, 0.04, 0.03, 0.005});
  EXPECT_NEAR(adjusted[0], 0.03, 1e-15);
  EXPECT_NEAR(adjusted[1], 0.06, 1e-15);
  EXPECT_NEAR(adjusted[2], 0.06, 1e-15);
  EXPECT_NEAR(adjusted[3], 0.02, 1e-15);
  EXPECT_EQ(holm_adjusted({0.7, 0.9})[1], 1);
  EXPECT_TRUE(holm_adjusted({}).empty());
}

TEST(Holm, LeavesOutWhatIsNoNumber) {
  const std::vector<double> adjusted = holm_adjusted({NAN, 0.01, NAN, 0.04, 0.03, 0.005});
  EXPECT_TRUE(std::isnan(adjusted[0]));
  EXPECT_TRUE(std::isnan(adjusted[2]));
  EXPECT_NEAR(adjusted[1], 0.03, 1e-15);
  EXPECT_NEAR(adjusted[3], 0.06, 1e-15);
  EXPECT_NEAR(adjusted[4], 0.06, 1e-15);
  EXPECT_NEAR(adjusted[5], 0.02, 1e-15);
}

}  // namespace
}  // namespace vernier
