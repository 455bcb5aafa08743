// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/odometry/floor_step.h"

#include <Eigen/Cholesky>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "calib/base/plane_vectors.h"
#include "calib/pose.h"
#include "calib/statistics/distributions.h"
#include "calib/statistics/draw_sources.h"
#include "localise/odometry.h"
#include "localise/odometry/step_consensus.h"
#include "localise/odometry/step_refinement.h"
#include "localise/place.h"

namespace vernier::localise::internal {

using namespace vernier::internal;

namespace {

constexpr std::size_t drawn_links = 2;

/// The step from two points, each given in both frames of the robot.
std::optional<Pose2D> step_of_two(const Eigen::Vector2d& from_a,
                                  const Eigen::Vector2d& from_b,
                                  const Eigen::Vector2d& to_a,
                                  const Eigen::Vector2d& to_b) {
  constexpr double nearest_m = 0.2;  // points above each other say nothing of the turn
  const Eigen::Vector2d from = from_b - from_a, to = to_b - to_a;
  if (from.norm() < nearest_m || to.norm() < nearest_m) return std::nullopt;
  const double turn = std::atan2(cross(to, from), to.dot(from));
  const double c = std::cos(turn), s = std::sin(turn);
  Eigen::Matrix2d R;
  R << c, -s, s, c;
  const Eigen::Vector2d t = 0.5 * (from_a + from_b) - R * (0.5 * (to_a + to_b));
  return Pose2D{t.x(), t.y(), turn};
}

}  // namespace

Pose camera_motion(const FloorViews& views, const Pose2D& step) {
  const Pose floor{rotation_from_vector({0, 0, step.heading_rad}), {step.x_m, step.y_m, 0}};
  return T_robot_camera(views.from).inverse() * floor * T_robot_camera(views.to);
}

Pose2D robot_step(const FloorViews& views, const Pose& T_from_to) {
  const Pose floor = T_robot_camera(views.from) * T_from_to * T_robot_camera(views.to).inverse();
  return {floor.t.x(), floor.t.y(), std::atan2(floor.R(1, 0), floor.R(0, 0))};
}

FloorBasis floor_basis(const FloorViews& views) {
  // The robot's turn is about an axis through its origin, above which the later camera stands: it
  // does not move this camera's centre.
  const Eigen::Matrix3d R_camera_robot = T_robot_camera(views.from).R.transpose();
  FloorBasis basis = FloorBasis::Zero();
  basis.block<3, 1>(3, 0) = R_camera_robot.col(0);
  basis.block<3, 1>(3, 1) = R_camera_robot.col(1);
  basis.block<3, 1>(0, 2) = R_camera_robot.col(2);
  return basis;
}

std::vector<TriangulatedLink> level_links(const FloorViews& views,
                                          std::vector<TriangulatedLink> links,
                                          double gate_probability) {
  const double gate = chi_squared_quantile(gate_probability, 1);
  const Pose from = T_robot_camera(views.from), to = T_robot_camera(views.to);
  const Eigen::RowVector3d up_from = from.R.row(2), up_to = to.R.row(2);
  std::erase_if(links, [&](const TriangulatedLink& link) {
    const double higher = (from * link.corner.x_from_m).z() - (to * link.x_to_m).z();
    const double variance = (up_from * link.covariance_from_m2 * up_from.transpose() +
                             up_to * link.covariance_to_m2 * up_to.transpose())
                                .value();
    return !(higher * higher <= gate * variance);
  });
  return links;
}

std::optional<AgreedMotion> floor_consensus(const FloorViews& views,
                                            const std::vector<TriangulatedLink>& links,
                                            const StepOptions& options) {
  const Pose from = T_robot_camera(views.from), to = T_robot_camera(views.to);
  std::vector<Eigen::Vector2d> in_from, in_to;
  for (const TriangulatedLink& link : links) {
    in_from.emplace_back((from * link.corner.x_from_m).head<2>());
    in_to.emplace_back((to * link.x_to_m).head<2>());
  }
  const FloorBasis basis = floor_basis(views);
  const auto solve = [&](std::span<const std::size_t> two) -> std::optional<Pose> {
    const std::size_t a = two[0], b = two[1];
    const auto step = step_of_two(in_from[a], in_from[b], in_to[a], in_to[b]);
    if (!step) return std::nullopt;
    // Depths are far less sure than pixels are.
    constexpr int iterations = 3;
    const Pose start = camera_motion(views, *step);
    const auto refined =
        refine_step(views.rigs, {links[a].corner, links[b].corner}, start, iterations, &basis);
    return refined ? refined->T_from_to : start;
  };
  return consensus(views.rigs.to, links, options,
                   {drawn_links, DrawSource::corner_consensus, solve});
}

std::optional<FloorStep> floor_step(const FloorViews& views,
                                    const std::vector<TriangulatedLink>& links,
                                    const Pose& start,
                                    const StepOptions& options) {
  const FloorBasis basis = floor_basis(views);
  const auto settled = settled_step(views.rigs, links, start, options, &basis);
  if (!settled) return std::nullopt;
  const Eigen::LDLT<Eigen::Matrix3d> information(basis.transpose() * settled->refined.information *
                                                 basis);
  if (information.info() != Eigen::Success || !information.isPositive()) return std::nullopt;
  FloorStep step;
  step.to_in_from = robot_step(views, settled->refined.T_from_to);
  step.covariance = information.solve(Eigen::Matrix3d::Identity());
  step.agreeing = static_cast<int>(settled->agreeing.size());
  step.support =
      support_of(views.rigs.to, links, settled->refined.T_from_to, options.gate_probability);
  return step;
}

}  // namespace vernier::localise::internal
