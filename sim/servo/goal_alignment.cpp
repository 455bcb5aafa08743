// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/servo/goal_alignment.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "calib/pose.h"
#include "calib/statistics/quantile.h"
#include "localise/place.h"
#include "sim/servo/stereo_line.h"

namespace vernier::sim::internal {

using namespace localise;
using namespace vernier::internal;

namespace {

constexpr int fewest_lines = 4;

/// Four rows of a match: error and its derivatives by the motion on the floor, rho in pixels and
/// theta in pixels at the ends of the line.
struct MatchRows {
  Eigen::Matrix<double, 4, 3> L;
  Eigen::Vector4d error;
};

MatchRows scaled(MatchRows rows, double focal_px, double length_px) {
  const Eigen::Vector4d scale(focal_px, length_px / 2, focal_px, length_px / 2);
  rows.L = scale.asDiagonal() * rows.L;
  rows.error = scale.asDiagonal() * rows.error;
  return rows;
}

double size_of(const MatchRows& rows, const Eigen::Vector3d& motion) {
  const Eigen::Vector4d left = rows.error + rows.L * motion;
  return std::hypot(left[0], left[2]);
}

/// Tukey's weight of each match.
std::vector<double> tukey_weights(std::span<const MatchRows> rows, const Eigen::Vector3d& motion) {
  constexpr double tuning = 4.685, to_sigma = 1.4826, least_px = 0.5;
  std::vector<double> sizes;
  for (const MatchRows& r : rows) sizes.push_back(size_of(r, motion));
  const double reach =
      tuning * std::max(least_px, to_sigma * quantile(sizes, 0.5, QuantileKind::linear));
  for (double& size : sizes) {
    const double u = size / reach;
    size = u < 1 ? (1 - u * u) * (1 - u * u) : 0;
  }
  return sizes;
}

/// The motion that removes the errors, by iterated weighted least squares; begins with weights that
/// give the absolute error.
std::optional<Eigen::Vector3d> robust_motion(std::span<const MatchRows> rows,
                                             std::vector<double>& weights) {
  constexpr int absolute_steps = 8, tukey_steps = 6;
  constexpr double least_px = 0.2;
  Eigen::Vector3d motion = Eigen::Vector3d::Zero();
  weights.assign(rows.size(), 1);
  for (int step = 0; step < absolute_steps + tukey_steps; ++step) {
    Eigen::Matrix3d A = Eigen::Matrix3d::Zero();
    Eigen::Vector3d b = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < rows.size(); ++i) {
      A += weights[i] * rows[i].L.transpose() * rows[i].L;
      b -= weights[i] * rows[i].L.transpose() * rows[i].error;
    }
    const Eigen::LDLT<Eigen::Matrix3d> solver(A);
    constexpr double worst = 1e-10;
    if (!(solver.rcond() > worst)) return std::nullopt;
    motion = solver.solve(b);
    if (step + 1 < absolute_steps) {
      for (std::size_t i = 0; i < rows.size(); ++i) {
        weights[i] = 1 / std::max(least_px, size_of(rows[i], motion));
      }
    } else {
      weights = tukey_weights(rows, motion);
    }
  }
  const auto inliers =
      std::count_if(weights.begin(), weights.end(), [](double w) { return w > 0; });
  if (inliers < fewest_lines) return std::nullopt;
  return motion;
}

GoalFix fix_of(std::span<const MatchRows> rows,
               const Eigen::Vector3d& motion,
               std::vector<double> weights) {
  GoalFix fix;
  double sum = 0, error = 0, left = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double size = size_of(rows[i], motion), now = size_of(rows[i], Eigen::Vector3d::Zero());
    sum += weights[i];
    error += weights[i] * now * now / 2;
    left += weights[i] * size * size / 2;
    fix.inliers += weights[i] > 0;
  }
  fix.image_error_px = std::sqrt(error / sum);
  fix.unexplained_px = std::sqrt(left / sum);
  fix.weights = std::move(weights);
  return fix;
}

}  // namespace

std::optional<GoalFix> goal_by_image_error(const DesiredView& desired,
                                           std::span<const LineMatch> matches) {
  if (matches.size() < fewest_lines) return std::nullopt;
  std::vector<MatchRows> rows;
  for (const LineMatch& match : matches) {
    const SeenLine& goal = desired.lines[static_cast<std::size_t>(match.line)];
    const auto of = [&](const SpaceLine& line) {
      return floor_interaction(line, goal.image, desired.T_right_left, desired.mount);
    };
    rows.push_back(scaled(
        {0.5 * (of(match.seen.space) + of(goal.space)), difference(match.seen.image, goal.image)},
        desired.focal_px, match.seen.length_px));
  }
  std::vector<double> weights;
  const auto motion = robust_motion(rows, weights);
  if (!motion) return std::nullopt;
  GoalFix fix = fix_of(rows, *motion, std::move(weights));
  fix.goal = floor_motion(*motion);
  return fix;
}

std::optional<GoalFix> align_goal(const DesiredView& desired,
                                  std::span<const LineMatch> matches,
                                  const Pose2D& start) {
  if (matches.size() < fewest_lines) return std::nullopt;
  constexpr int steps = 4;
  GoalFix fix;
  Pose2D goal = start;
  for (int step = 0; step < steps; ++step) {
    // From the goal the robot is at `here`; moving it there changes the images of the goal's lines.
    const Pose2D here = relative({}, goal);
    const Pose T = T_left_left(here, {}, desired.mount);
    std::vector<MatchRows> rows;
    for (const LineMatch& match : matches) {
      const SpaceLine line = moved(desired.lines[static_cast<std::size_t>(match.line)].space, T);
      rows.push_back(
          scaled({floor_interaction(line, match.seen.image, desired.T_right_left, desired.mount),
                  difference(image_of(line, desired.T_right_left), match.seen.image)},
                 desired.focal_px, match.seen.length_px));
    }
    std::vector<double> weights;
    const auto motion = robust_motion(rows, weights);
    if (!motion) return std::nullopt;
    fix = fix_of(rows, *motion, std::move(weights));
    goal = relative({}, compose(here, floor_motion(*motion)));
  }
  fix.goal = goal;
  return fix;
}

}  // namespace vernier::sim::internal
