// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/rectification/rectification_covariance.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <limits>

#include "calib/camera.h"
#include "calib/camera/ray_derivatives.h"
#include "calib/error.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "calib/triangulation.h"
#include "stereo/rectification.h"

namespace vernier::stereo::internal {

using namespace vernier::internal;

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using ByPose = Eigen::Matrix<double, 3, 6>;

/// Derivative of v / |v| for a vector v with a given derivative.
ByPose of_unit(const Vector3d& vector, const ByPose& by_pose) {
  const Vector3d unit = vector.normalized();
  return (Matrix3d::Identity() - unit * unit.transpose()) * by_pose / vector.norm();
}

/// Derivative of (y_x / y_z, y_y / y_z) by y.
Eigen::Matrix<double, 2, 3> perspective_by(const Vector3d& y) {
  Eigen::Matrix<double, 2, 3> J;
  J << 1, 0, -y.x() / y.z(), 0, 1, -y.y() / y.z();
  return J / y.z();
}

}  // namespace

RectificationUncertainty::RectificationUncertainty(const Rig& rig,
                                                   const Eigen::MatrixXd& covariance,
                                                   const RectifiedGeometry& geometry)
    : rig_(rig),
      covariance_(covariance),
      geometry_(geometry),
      raw_left_(rig, geometry, 0),
      raw_right_(rig, geometry, 1) {
  const Eigen::Index n = parameter_count(rig);
  if (rig.cameras.size() != 2 || covariance.rows() != n || covariance.cols() != n) {
    throw Error("rectification",
                fmt::format("the rig has {} cameras and {} parameters, the covariance is {} x {}",
                            rig.cameras.size(), n, covariance.rows(), covariance.cols()),
                "use a rig of two cameras with its own covariance");
  }
  // As in stereo/rectification/rectification.cpp: x along b = −Rᵀ t, y along c = (e_z + Rᵀ e_z) ×
  // x, z = x × y.
  const Pose& T = rig.T_camera_first[1];
  const Matrix3d Rt = T.R.transpose();
  const Vector3d b = -(Rt * T.t), x = b.normalized();
  const Vector3d a = Vector3d::UnitZ() + Rt.col(2), c = a.cross(x), y = c.normalized();
  ByPose b_by_pose, a_by_pose;
  b_by_pose << -Rt * hat(T.t), -Rt;  // Rᵀ -> Rᵀ (1 − [w]x)
  a_by_pose << Rt * hat(Vector3d::UnitZ()), Matrix3d::Zero();
  x_by_pose_ = of_unit(b, b_by_pose);
  y_by_pose_ = of_unit(c, hat(a) * x_by_pose_ - hat(x) * a_by_pose);
  z_by_pose_ = hat(x) * y_by_pose_ - hat(y) * x_by_pose_;
}

std::optional<RectificationUncertainty::Derivatives> RectificationUncertainty::by_rig(
    const PixelPair& raw) const {
  const auto left = try_unproject(rig_.cameras[0], raw.first_px);
  const auto right = try_unproject(rig_.cameras[1], raw.other_px);
  if (!left || !right) return std::nullopt;
  const Matrix3d& X = geometry_.turn.R_rectified_left;
  const Matrix3d Rt = rig_.T_camera_first[1].R.transpose();
  const Vector3d back = Rt * *right;  // the right ray in the left frame
  const Vector3d y_left = X * *left, y_right = X * back;
  if (!(y_left.z() > 0) || !(y_right.z() > 0)) return std::nullopt;

  ByPose left_by_pose, right_by_pose, back_by_pose;
  left_by_pose << left->transpose() * x_by_pose_, left->transpose() * y_by_pose_,
      left->transpose() * z_by_pose_;
  back_by_pose << Rt * hat(*right), Matrix3d::Zero();  // −Rᵀ [w]x r
  right_by_pose << back.transpose() * x_by_pose_, back.transpose() * y_by_pose_,
      back.transpose() * z_by_pose_;
  right_by_pose += X * back_by_pose;

  const auto at_left = perspective_by(y_left), at_right = perspective_by(y_right);
  Derivatives J(2, covariance_.cols());
  const Eigen::Index of_left = rig_.cameras[0].parameters.size();
  const Eigen::Index of_right = rig_.cameras[1].parameters.size();
  J.leftCols(of_left) = at_left * X * derivatives_of_ray(rig_.cameras[0], *left).by_camera;
  J.middleCols(of_left, of_right) =
      -at_right * X * Rt * derivatives_of_ray(rig_.cameras[1], *right).by_camera;
  J.middleCols<6>(pose_index(rig_, 1)) = at_left * left_by_pose - at_right * right_by_pose;
  return geometry_.f_px * J;
}

std::optional<RectificationUncertainty::Derivatives> RectificationUncertainty::by_rig(
    const Eigen::Vector2d& left_px, double disparity_px) const {
  const auto left = raw_left_.at(left_px);
  const auto right = raw_right_.at(left_px - Eigen::Vector2d(disparity_px, 0));
  if (!left || !right) return std::nullopt;
  return by_rig(PixelPair{*left, *right});
}

std::optional<Eigen::Matrix2d> RectificationUncertainty::covariance_px2(
    const Eigen::Vector2d& left_px, double disparity_px) const {
  const auto J = by_rig(left_px, disparity_px);
  if (!J) return std::nullopt;
  return *J * covariance_ * J->transpose();
}

double disparity_variance_px2(const Eigen::Matrix2d& covariance_px2,
                              const Eigen::Vector2d& edge_normal) {
  if (edge_normal.x() == 0) return std::numeric_limits<double>::infinity();
  const Eigen::RowVector2d by_errors(1, edge_normal.y() / edge_normal.x());
  return (by_errors * covariance_px2 * by_errors.transpose()).value();
}

}  // namespace vernier::stereo::internal
