// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/equal_density.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/error_message.h"

namespace vernier {
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
  const SceneCurves a{curve({{0.9, 0.02}, {0.5, 0.01}}), {curve({{0.8, 0.04}, {0.4, 0.02}})}};
  const SceneCurves b{curve({{0.6, 0.03}}), {curve({{1.0, 0.10}, {0.5, 0.05}})}};
  const EqualDensity e = at_equal_density({a, b});
  EXPECT_NEAR(e.density, 0.5 * (0.8 + 0.6), 1e-12);
  EXPECT_NEAR(e.own_bad_1, 0.5 * (0.0175 + 0.03), 1e-12);
  EXPECT_NEAR(e.peer_bad_1, 0.5 * (0.04 + 0.06), 1e-12);
  EXPECT_NEAR(e.ratio, 0.0475 / 0.1, 1e-12);
  // Two scenes: the resamples are aa, ab, bb.
  EXPECT_NEAR(e.interval.low, 0.0175 / 0.04, 1e-9);
  EXPECT_NEAR(e.interval.high, 0.03 / 0.06, 1e-9);
}

TEST(EqualDensity, TakesThePeersBestSetting) {
  const SceneCurves scene{curve({{0.9, 0.02}}),
                          {curve({{0.9, 0.04}}), curve({{0.9, 0.01}}), curve({{0.9, 0.03}})}};
  const EqualDensity e = at_equal_density({scene});
  EXPECT_EQ(e.setting, 1u);
  EXPECT_NEAR(e.ratio, 2, 1e-12);
  EXPECT_TRUE(std::isnan(e.interval.low));  // one scene says nothing of others
}

TEST(EqualDensity, APeerWithoutErrorsHasNoRatio) {
  EXPECT_TRUE(std::isnan(at_equal_density({{curve({{1, 0.1}}), {curve({{1, 0}})}}}).ratio));
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
