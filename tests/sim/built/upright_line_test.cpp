// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/built/upright_line.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "calib/statistics/random.h"
#include "localise/joined_lines.h"
#include "sim/built/built_world.h"
#include "sim/study/upright_edges.h"

namespace vernier::sim::internal {
namespace {

using Eigen::Vector3d;
using vernier::internal::RandomStream;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

constexpr double degree = std::numbers::pi / 180;

/// Of both ends, unlike in all directions and alike at both.
Matrix6d covariance(double scale_m) {
  Matrix6d root = Matrix6d::Identity() * 0.3;
  for (int i = 0; i < 6; ++i) {
    for (int k = 0; k < i; ++k) root(i, k) = 0.15 * std::sin(1.0 + 3 * i + 7 * k);
  }
  root(3, 0) = 0.8;
  return scale_m * scale_m * root * root.transpose();
}

localise::JoinedLine line(const Vector3d& a, const Vector3d& b, const Matrix6d& C) {
  localise::JoinedLine made;
  made.a_m = a;
  made.b_m = b;
  made.covariance_m2 = C;
  made.views = 3;
  return made;
}

TEST(UprightLine, IsMissedByOneIn370) {
  constexpr int trials = 20'000;
  const Matrix6d C = covariance(0.02), root = C.llt().matrixL();
  int upright = 0;
  for (int t = 0; t < trials; ++t) {
    RandomStream draws({.seed = 8, .trial = static_cast<std::uint32_t>(t)});
    Eigen::Matrix<double, 6, 1> z;
    for (double& value : z) value = draws.normal();
    const Eigen::Matrix<double, 6, 1> error = root * z;
    const Vector3d a = Vector3d(1, 2, 0.5) + error.head<3>();
    const Vector3d b = Vector3d(1, 2, 2) + error.tail<3>();
    upright += may_be_upright(line(a, b, C), 80 * degree) ? 1 : 0;
  }
  // 4 sigma of the binomial: wrong once in 16,000 runs
  EXPECT_NEAR(upright, 0.9973 * trials, 4 * std::sqrt(trials * 0.0027));
}

TEST(UprightLine, LeansNoMoreThanItsCovarianceOrTheLimitAllow) {
  const auto leaning = [](double angle_rad, double sigma_m, double most_rad) {
    const Matrix6d C = sigma_m * sigma_m * Matrix6d::Identity();
    const Vector3d b(std::cos(0.7) * std::sin(angle_rad), std::sin(0.7) * std::sin(angle_rad),
                     -std::cos(angle_rad));
    return may_be_upright(line({0, 0, 0}, b, C), most_rad);
  };
  EXPECT_TRUE(leaning(1.9 * degree, 1, 2 * degree));
  EXPECT_FALSE(leaning(2.1 * degree, 1, 2 * degree));
  // sqrt(2 * 11.83) sigma of the offset of two independent ends
  const double offset_m = std::sin(1 * degree), borderline_m = offset_m / std::sqrt(2 * 11.829);
  EXPECT_TRUE(leaning(1 * degree, 1.001 * borderline_m, 2 * degree));
  EXPECT_FALSE(leaning(1 * degree, 0.999 * borderline_m, 2 * degree));
  // exactly known: upright only if it is
  EXPECT_TRUE(leaning(0, 0, 2 * degree));
  EXPECT_FALSE(leaning(0.01 * degree, 0, 2 * degree));
  EXPECT_FALSE(leaning(90 * degree, 10, 10 * degree));
}

TEST(UprightLine, StandsOverItsMiddleInTheBuiltWorld) {
  const Matrix6d C = covariance(0.02);
  localise::JoinedLines lines;
  lines.lines = {line({1, 1, 0.2}, {1.02, 0.99, 2}, C), line({1, 2, 0}, {1.3, 2, 2}, C),
                 line({2, 3, 1}, {3, 3, 1}, C)};
  const std::vector<Pose> way{{Eigen::Matrix3d::Identity(), {0, 0, 1}},
                              {Eigen::Matrix3d::Identity(), {1, 0, 1}}};
  const BuiltWorld built = built_world(lines, {}, way);
  EXPECT_EQ(built.report.upright, 1U);
  const auto& [a_m, b_m] = built.world.loose.segments_m[0];
  EXPECT_TRUE(is_upright(a_m, b_m));
  EXPECT_NEAR((a_m - Vector3d(1.01, 0.995, 0.2)).norm(), 0, 1e-12);
  EXPECT_NEAR((b_m - Vector3d(1.01, 0.995, 2)).norm(), 0, 1e-12);
  for (const std::size_t i : {1U, 2U}) {
    EXPECT_EQ(built.world.loose.segments_m[i].first, lines.lines[i].a_m);
    EXPECT_EQ(built.world.loose.segments_m[i].second, lines.lines[i].b_m);
  }
  const BuiltWorld as_measured = built_world(lines, {}, way, {.upright_rad = 0});
  EXPECT_EQ(as_measured.report.upright, 0U);
  EXPECT_EQ(as_measured.world.loose.segments_m[0].second, lines.lines[0].b_m);
}

}  // namespace
}  // namespace vernier::sim::internal
