// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/projection_uncertainty.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>

#include "calib/camera.h"
#include "calib/error.h"
#include "calib/estimate/covariance_check.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "calib/rig_and_boards.h"
#include "calib/uncertainty/pose_covariance.h"

namespace vernier {

using namespace internal;

namespace {

constexpr int max_columns = core_parameter_count + max_distortion_count + 6 + 6;  // pose, motion
using Sensitivity = Eigen::Matrix<double, 2, Eigen::Dynamic, Eigen::ColMajor, 2, max_columns>;

void check_camera(const Rig& rig, int camera) {
  if (camera >= 0 && camera < static_cast<int>(rig.cameras.size())) return;
  throw Error("projection uncertainty",
              fmt::format("the rig has no camera {}: it has {}", camera, rig.cameras.size()),
              "count cameras from 0");
}

void check_distance(double distance_m) {
  if (distance_m > 0) return;  // NaN fails too
  throw Error("projection uncertainty", fmt::format("a distance of {} m", distance_m),
              "give distances above 0, or inf");
}

}  // namespace

void ProjectionUncertainty::keep(const Eigen::MatrixXd& joint,
                                 const Rig& rig,
                                 int camera,
                                 bool with_motion) {
  check_camera(rig, camera);
  camera_ = rig.cameras[camera];
  T_camera_first_ = rig.T_camera_first[camera];
  has_pose_ = camera > 0 && fixed_to_ != PointFixedTo::camera;
  std::vector<Eigen::Index> rows(static_cast<std::size_t>(camera_.parameters.size()));
  std::iota(rows.begin(), rows.end(), intrinsics_index(rig, camera));
  const auto append_six = [&](Eigen::Index first) {
    for (Eigen::Index i = 0; i < 6; ++i) rows.push_back(first + i);
  };
  if (has_pose_) append_six(pose_index(rig, camera));
  if (with_motion) append_six(parameter_count(rig));
  covariance_ = joint(rows, rows);
}

ProjectionUncertainty::ProjectionUncertainty(const RigAndBoards& joint,
                                             int camera,
                                             PointFixedTo fixed_to)
    : fixed_to_(fixed_to) {
  check_covariance(joint.rig_covariance, joint.rig, "projection uncertainty");
  const bool with_motion = fixed_to == PointFixedTo::boards;
  keep(with_motion ? rig_and_motion_covariance(joint) : joint.rig_covariance, joint.rig, camera,
       with_motion);
}

ProjectionUncertainty::ProjectionUncertainty(const Rig& rig,
                                             const Eigen::MatrixXd& rig_covariance,
                                             int camera,
                                             PointFixedTo fixed_to)
    : fixed_to_(fixed_to) {
  if (fixed_to == PointFixedTo::boards) {
    throw Error("projection uncertainty",
                "a point fixed to the boards needs their poses, and a rig alone has none",
                "calibrate with evidence, or fix the point to a camera");
  }
  check_covariance(rig_covariance, rig, "projection uncertainty");
  keep(rig_covariance, rig, camera, false);
}

Eigen::Matrix2d ProjectionUncertainty::covariance_of_point(const Eigen::Vector3d& x_camera) const {
  return covariance_at(x_camera, Range::finite);
}

Eigen::Matrix2d ProjectionUncertainty::covariance_of_direction(
    const Eigen::Vector3d& x_camera) const {
  return covariance_at(x_camera, Range::infinite);
}

Eigen::Matrix2d ProjectionUncertainty::covariance_at(const Eigen::Vector3d& x_camera,
                                                     Range range) const {
  const bool at_infinity = range == Range::infinite;
  ProjectionJacobian J;
  project(camera_, x_camera, J);
  const auto intrinsics = J.camera.cols();
  Sensitivity S = Sensitivity::Zero(2, covariance_.cols());
  S.leftCols(intrinsics) = J.camera;
  auto at = intrinsics;
  if (has_pose_) {
    const Eigen::Vector3d turned = at_infinity ? x_camera : x_camera - T_camera_first_.t;
    S.middleCols<3>(at).noalias() = -J.point * hat(turned);
    if (!at_infinity) S.middleCols<3>(at + 3) = J.point;
    at += 6;
  }
  if (fixed_to_ == PointFixedTo::boards) {
    const Eigen::Vector3d x_first =
        T_camera_first_.R.transpose() * (at_infinity ? x_camera : x_camera - T_camera_first_.t);
    const Eigen::Matrix<double, 2, 3> by_first = J.point * T_camera_first_.R;
    S.middleCols<3>(at).noalias() = -by_first * hat(x_first);
    if (!at_infinity) S.middleCols<3>(at + 3) = by_first;
  }
  const Sensitivity SC = S.lazyProduct(covariance_);
  const Eigen::Matrix2d C = SC.lazyProduct(S.transpose());
  return 0.5 * (C + C.transpose());
}

std::optional<Eigen::Matrix2d> ProjectionUncertainty::covariance(const Eigen::Vector2d& pixel,
                                                                 double distance_m) const {
  check_distance(distance_m);
  const auto ray = try_unproject(camera_, pixel);
  if (!ray) return std::nullopt;
  const Eigen::Vector3d direction = ray->normalized();
  if (std::isinf(distance_m)) return covariance_of_direction(direction);
  return covariance_of_point(distance_m * direction);
}

double worst_sd(const Eigen::Matrix2d& C) {
  const double mean = 0.5 * (C(0, 0) + C(1, 1)), half = 0.5 * (C(0, 0) - C(1, 1));
  return std::sqrt(mean + std::hypot(half, C(0, 1)));
}

ProjectionGrid projection_grid(const ProjectionUncertainty& uncertainty,
                               const ProjectionGridOptions& options) {
  const auto [columns, rows, distance_m] = options;
  check_distance(distance_m);
  if (columns < 2 || rows < 2) {
    throw Error("projection uncertainty", fmt::format("a grid of {}x{}", columns, rows),
                "give at least 2x2");
  }
  const auto ticks = [](int count, int size_px) {
    std::vector<double> at(static_cast<std::size_t>(count));
    for (int i = 0; i < count; ++i) at[i] = static_cast<double>(i) * (size_px - 1) / (count - 1);
    return at;
  };
  const Eigen::Vector2i size = uncertainty.camera().size_px;
  ProjectionGrid grid{columns, rows, ticks(columns, size[0]), ticks(rows, size[1]), {}, 0};
  grid.covariance.reserve(static_cast<std::size_t>(columns) * rows);
  for (const double y : grid.y_px) {
    for (const double x : grid.x_px) {
      const auto C = uncertainty.covariance({x, y}, distance_m);
      if (!C) ++grid.absent;
      grid.covariance.push_back(
          C.value_or(Eigen::Matrix2d::Constant(std::numeric_limits<double>::quiet_NaN())));
    }
  }
  return grid;
}

}  // namespace vernier
