// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/statistics/quantile.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include "tests/support/error_message.h"

namespace vernier {

using namespace vernier::internal;

namespace {

TEST(Quantile, KindsDifferAsTheySay) {
  const std::vector<double> four{4, 1, 3, 2};
  EXPECT_EQ(quantile(four, 0.5, QuantileKind::lower), 2);
  EXPECT_EQ(quantile(four, 0.5, QuantileKind::upper), 3);
  EXPECT_EQ(quantile(four, 0.5, QuantileKind::linear), 2.5);
  EXPECT_EQ(quantile(four, 0.25, QuantileKind::linear), 1.75);
  for (const QuantileKind kind : {QuantileKind::lower, QuantileKind::upper, QuantileKind::linear}) {
    EXPECT_EQ(quantile(four, 0, kind), 1);
    EXPECT_EQ(quantile(four, 1, kind), 4);
    EXPECT_EQ(quantile(std::vector<double>{7}, 0.3, kind), 7);
  }
}

// A fifth of 5 k values is the k-th whatever rounding makes of 0.2 · 5 k.
TEST(Quantile, UpperCountsWholeValues) {
  for (int k = 1; k < 200; ++k) {
    std::vector<float> values(static_cast<std::size_t>(5 * k));
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<float>(i);
    EXPECT_EQ(quantile(values, 0.2, QuantileKind::upper), static_cast<float>(k));
  }
}

TEST(Quantile, InfinitiesDoNotBecomeNoNumbers) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const std::vector<double> values{infinity, 1, infinity, 2};
  EXPECT_EQ(quantile(values, 0.9, QuantileKind::linear), infinity);
  EXPECT_EQ(quantile(values, 0.5, QuantileKind::linear), infinity);
}

TEST(Quantile, OfNothingIsAnError) {
  const auto of_nothing = [] { quantile(std::vector<double>{}, 0.5, QuantileKind::linear); };
  EXPECT_NE(test::error_message(of_nothing).find("no values"), std::string::npos);
  const auto beyond = [] { quantile(std::vector<double>{1}, 95, QuantileKind::linear); };
  EXPECT_NE(test::error_message(beyond).find("not in [0, 1]"), std::string::npos);
  EXPECT_EQ(median_or_zero(std::vector<double>{}), 0);
}

}  // namespace
}  // namespace vernier
