// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/evaluation/equal_density.h"

#include <gtest/gtest.h>

#include <cmath>

#include "stereo/matcher_evaluation.h"
#include "tests/support/error_message.h"

namespace vernier {

using namespace vernier::stereo;
using namespace vernier::stereo::internal;

namespace {

std::vector<CurvePoint> curve(std::initializer_list<std::pair<double, double>> points) {
  std::vector<CurvePoint> result;
  for (const auto& [density, bad_1] : points) {
    result.emplace_back();
    result.back().density = density;
    result.back().bad_1 = bad_1;
  }
  return result;
}

TEST(EqualDensity, ComparesAtTheLargestThatBothReach) {
  const DensityCurves a{curve({{0.9, 0.02}, {0.5, 0.01}}), {curve({{0.8, 0.04}, {0.4, 0.02}})}};
  const DensityCurves b{curve({{0.6, 0.03}}), {curve({{1.0, 0.10}, {0.5, 0.05}})}};
  const EqualDensity e = at_equal_density({a, b});
  EXPECT_NEAR(e.density, 0.5 * (0.8 + 0.6), 1e-12);
  EXPECT_NEAR(e.own_bad_1, 0.5 * (0.0175 + 0.03), 1e-12);
  EXPECT_NEAR(e.peer_bad_1, 0.5 * (0.04 + 0.06), 1e-12);
  EXPECT_NEAR(e.ratio, 0.0475 / 0.1, 1e-12);
  EXPECT_TRUE(std::isnan(e.interval.low));  // of two scenes no interval is worth its name
}

TEST(EqualDensity, TakesThePeersBestSetting) {
  const DensityCurves scene{curve({{0.9, 0.02}}),
                            {curve({{0.9, 0.04}}), curve({{0.9, 0.01}}), curve({{0.9, 0.03}})}};
  const EqualDensity e = at_equal_density({scene});
  EXPECT_EQ(e.setting, 1u);
  EXPECT_NEAR(e.ratio, 2, 1e-12);
  EXPECT_TRUE(std::isnan(e.interval.low));  // one scene says nothing of others
}

TEST(EqualDensity, AnIntervalHoldsTheRatioAndIsThatOfResampledScenes) {
  std::vector<DensityCurves> scenes;
  for (int k = 0; k < 12; ++k) {
    const double own = 0.02 + 0.005 * (k % 4);
    scenes.push_back({curve({{0.9, own}}), {curve({{0.9, 0.03 + 0.002 * (k % 3)}})}});
  }
  const EqualDensity e = at_equal_density(scenes);
  EXPECT_LT(e.interval.low, e.ratio);
  EXPECT_GT(e.interval.high, e.ratio);
  // Of a ratio of means: relative deviation of own 0.204, of the peer 0.051, unrelated, of 12
  // scenes; t of 11 degrees of freedom.
  const double half = 2.2 * e.ratio * std::sqrt((0.204 * 0.204 + 0.051 * 0.051) / 11);
  EXPECT_NEAR(e.ratio - e.interval.low, half, 0.2 * half);
  EXPECT_NEAR(e.interval.high - e.ratio, half, 0.2 * half);
}

// Three scenes widen an interval by 2.7, of which one to both sides of the ratio would be negative.
TEST(EqualDensity, AnIntervalIsNotBelowZero) {
  const auto scene = [](double own, double peer) {
    return DensityCurves{curve({{0.9, own}}), {curve({{0.9, peer}})}};
  };
  const EqualDensity e =
      at_equal_density({scene(0.001, 0.02), scene(0.02, 0.03), scene(0.004, 0.02)});
  EXPECT_GT(e.interval.low, 0);
  EXPECT_LT(e.interval.low, e.ratio);
  EXPECT_GT(e.interval.high, e.ratio);
  // The other way round it is the reciprocal.
  const EqualDensity other =
      at_equal_density({scene(0.02, 0.001), scene(0.03, 0.02), scene(0.02, 0.004)});
  EXPECT_NEAR(other.interval.low * e.interval.high, 1, 1e-9);
  EXPECT_NEAR(other.interval.high * e.interval.low, 1, 1e-9);
}

TEST(EqualDensity, APeerWithoutErrorsIsTheBest) {
  const DensityCurves scene{curve({{0.9, 0.02}}), {curve({{0.9, 0.04}}), curve({{0.9, 0}})}};
  const EqualDensity e = at_equal_density({scene});
  EXPECT_EQ(e.setting, 1u);
  EXPECT_TRUE(std::isinf(e.ratio));
  const DensityCurves none{curve({{0.9, 0}}), {curve({{0.9, 0}})}};
  EXPECT_TRUE(std::isnan(at_equal_density({none}).ratio));
  // Resamples without the one scene where the peer errs are not left out.
  const DensityCurves clean{curve({{0.9, 0.02}}), {curve({{0.9, 0}})}};
  const DensityCurves dirty{curve({{0.9, 0.02}}), {curve({{0.9, 0.1}})}};
  EXPECT_TRUE(std::isinf(at_equal_density({clean, clean, clean, dirty}).interval.high));
}

TEST(EqualDensity, RefusesAnEmptyCurve) {
  EXPECT_NE(test::error_message([] { at_equal_density({}); }).find("without curves"),
            std::string::npos);
  EXPECT_NE(test::error_message([] {
              at_equal_density({{curve({{1, 0}}), {{}}}});
            }).find("without curves"),
            std::string::npos);
}

}  // namespace
}  // namespace vernier
