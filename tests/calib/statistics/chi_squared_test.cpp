// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/statistics/chi_squared.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

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
}

TEST(ChiSquared, RefusesWhatIsNoNumber) {
  EXPECT_NE(test::error_message([] { chi_squared_survival(1, 0); }).find("degrees of freedom"),
            std::string::npos);
  EXPECT_NE(test::error_message([] { chi_squared_survival(std::nan(""), 3); }).find("not a number"),
            std::string::npos);
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

}  // namespace
}  // namespace vernier
