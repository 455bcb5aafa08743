// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <cstdint>

#include "calib/statistics/distributions.h"
#include "localise/place.h"
#include "sim/differential_drive.h"

namespace vernier {

using namespace vernier::internal;
using namespace vernier::localise;
using namespace vernier::sim;

namespace {

/// Sum of squares over the variance, of `n` normal values: both tails, together wrong once in
/// 10,000 runs of other seeds (seeds here are fixed).
void expect_variance(double sum_of_squares, double variance, int n) {
  EXPECT_GT(sum_of_squares / variance, chi_squared_quantile(0.5e-4, n));
  EXPECT_LT(sum_of_squares / variance, chi_squared_quantile(1 - 0.5e-4, n));
}

// The way and the turn of a drive in `steps` steps have the variances of the alphas, whatever the
// steps are.
TEST(OdometryError, NoiseGrowsWithTheWayAndTheTurn) {
  OdometryError error = no_odometry_error();
  error.turn_per_turn = 4e-4;
  error.turn_per_way = 1e-4;
  error.way_per_way = 9e-4;
  error.way_per_turn = 2e-4;
  const DifferentialDrive drive;
  constexpr int trials = 4000;
  for (const int steps : {1, 10}) {
    double way2 = 0, turn2 = 0, both = 0;
    for (std::uint32_t trial = 0; trial < trials; ++trial) {
      const OdometryDraw draw(drive, error, 11, trial);
      WheelSpeeds wheels{0.2, 0.6};  // 0.4 m/s, 1 rad/s
      double way = 0, turn = 0;
      for (int i = 0; i < steps; ++i) {
        for (const DrivePhase& p :
             draw.true_phases(wheel_phases(drive, {0.4, 1, 2.0 / steps}, wheels),
                              static_cast<std::uint32_t>(i))) {
          way += p.speed0_mps * p.duration_s;
          turn += p.turn0_radps * p.duration_s;
        }
      }
      way2 += (way - 0.8) * (way - 0.8);
      turn2 += (turn - 2) * (turn - 2);
      both += (way - 0.8) * (turn - 2);
    }
    const double way_variance = 9e-4 * 0.8 + 2e-4 * 2, turn_variance = 4e-4 * 2 + 1e-4 * 0.8;
    expect_variance(way2, way_variance, trials);
    expect_variance(turn2, turn_variance, trials);
    // They are independent: a correlation beyond 4.06 / √n is seen once in 20,000 runs.
    EXPECT_LT(std::abs(both) / std::sqrt(way_variance * turn_variance), 4.06 * std::sqrt(trials));
  }
}

// Wheels of other sizes and another base make a straight drive an arc, by Borenstein and Feng's
// equations: heading (r_R - r_L) s / b, and a turn longer by 1 / (1 + e).
TEST(OdometryError, WheelsAndBaseAreDrawnOnceATrial) {
  OdometryError error = no_odometry_error();
  error.wheel_sd = 0.01;
  error.wheel_base_sd = 0.02;
  const DifferentialDrive drive;
  constexpr int trials = 4000;
  double straight2 = 0, way2 = 0, turn2 = 0;
  for (std::uint32_t trial = 0; trial < trials; ++trial) {
    const OdometryDraw draw(drive, error, 12, trial);
    WheelSpeeds straight{0.5, 0.5}, spin{-0.2, 0.2};
    const DrivePhase along = draw.true_phases(wheel_phases(drive, {0.5, 0, 1}, straight), 1).at(0);
    const DrivePhase round = draw.true_phases(wheel_phases(drive, {0, 1, 1}, spin), 2).at(0);
    straight2 += along.turn0_radps * along.turn0_radps;
    way2 += (along.speed0_mps - 0.5) * (along.speed0_mps - 0.5);
    // A spin is slower by the wheels' mean, and by the base.
    const double of_base = along.speed0_mps / 0.5 / round.turn0_radps - 1;
    turn2 += of_base * of_base;
    EXPECT_EQ(along.turn0_radps,
              draw.true_phases(wheel_phases(drive, {0.5, 0, 1}, straight), 9).at(0).turn0_radps);
  }
  // With a base of 1 + e the heading is divided by it: 1 + 3 e² of the variance is within 0.2 %.
  const double turn_variance = 2 * std::pow(0.01 * 0.5 / 0.4, 2) * (1 + 3 * 0.02 * 0.02);
  expect_variance(straight2, turn_variance, trials);
  expect_variance(way2, 0.5 * std::pow(0.01 * 0.5, 2), trials);
  expect_variance(turn2, 0.02 * 0.02, trials);
}

// The position after an arc: the Monte-Carlo covariance against the linear propagation of the two
// noises through the end of the arc, both along and across.
TEST(OdometryError, CovarianceOfTheEndIsThatOfItsPropagation) {
  OdometryError error = no_odometry_error();
  error.turn_per_way = 2e-5;
  error.way_per_way = 2e-5;
  const DifferentialDrive drive;
  constexpr int trials = 4000;
  constexpr double v = 0.5, w = 0.8, t = 1.5, h = 1e-5;
  const auto end = [&](double speed, double turn) {
    const Pose2D p = DrivePhase{t, speed, speed, turn, turn}.after(t);
    return Eigen::Vector3d(p.x_m, p.y_m, p.heading_rad);
  };
  Eigen::Matrix<double, 3, 2> J;  // by the way and by the turn
  J.col(0) = (end(v + h / t, w) - end(v - h / t, w)) / (2 * h);
  J.col(1) = (end(v, w + h / t) - end(v, w - h / t)) / (2 * h);
  const Eigen::Matrix3d predicted = 2e-5 * v * t * J * J.transpose();
  const Eigen::Vector3d mean = end(v, w);
  Eigen::Vector3d squares = Eigen::Vector3d::Zero();
  for (std::uint32_t trial = 0; trial < trials; ++trial) {
    const OdometryDraw draw(drive, error, 13, trial);
    WheelSpeeds wheels{v - 0.2 * w, v + 0.2 * w};
    const Pose2D p = after(draw.true_phases(wheel_phases(drive, {v, w, t}, wheels), 1));
    const Eigen::Vector3d off = Eigen::Vector3d(p.x_m, p.y_m, p.heading_rad) - mean;
    squares += off.cwiseAbs2();
  }
  for (int i = 0; i < 3; ++i) expect_variance(squares[i], predicted(i, i), trials);
}

}  // namespace
}  // namespace vernier
