// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/estimate/stable_coordinates.h"

#include <Eigen/Geometry>
#include <cstddef>
#include <utility>
#include <vector>

#include "calib/estimate/stable_camera.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "calib/statistics/scaled_root.h"

namespace vernier::internal {
namespace {

/// The part of the tangent that belongs to the intrinsics of a camera.
Eigen::VectorXd intrinsics_of(const Rig& rig, const Eigen::VectorXd& tangent, std::size_t camera) {
  return tangent.segment(intrinsics_index(rig, static_cast<int>(camera)),
                         rig.cameras[camera].parameters.size());
}

/// Of the parameters with a variance.
bool has_null_direction(const Eigen::MatrixXd& covariance) {
  std::vector<Eigen::Index> free;
  for (Eigen::Index i = 0; i < covariance.rows(); ++i) {
    if (covariance(i, i) > 0) free.push_back(i);
  }
  if (free.empty()) return true;
  constexpr double rounding = 1e-14;
  const Eigen::VectorXd s = ScaledEigen(covariance(free, free)).values;
  return !(s.minCoeff() > rounding * s.maxCoeff());
}

MovedRig in_tangent(const Rig& mean, const Eigen::VectorXd& delta) {
  return {retract(mean, delta), Eigen::Matrix3d::Identity(), Eigen::Vector3d::Zero()};
}

}  // namespace

StablePosition tangent_position(const Rig& rig, const Rig& mean) {
  StablePosition at{difference(rig, mean), {}};
  at.by_rig = Eigen::MatrixXd::Identity(at.delta.size(), at.delta.size());
  for (std::size_t c = 1; c < mean.cameras.size(); ++c) {
    const int p = pose_index(mean, static_cast<int>(c));
    at.by_rig.block<3, 3>(p, p) = left_jacobian(at.delta.segment<3>(p)).inverse();
  }
  return at;
}

StableCoordinates::StableCoordinates(const Rig& mean, const Eigen::MatrixXd& covariance)
    : mean_(mean) {
  for (std::size_t c = 0; c < mean.cameras.size(); ++c) {
    const int i = intrinsics_index(mean, static_cast<int>(c));
    const auto n = mean.cameras[c].parameters.size();
    cameras_.emplace_back(mean.cameras[c], covariance.block(i, i, n, n));
  }
  const auto poses = pose_index(mean, 1);
  is_tangent_ = (covariance.diagonal().tail(covariance.rows() - poses).array() <= 0).any() ||
                has_null_direction(covariance);
}

std::optional<MovedRig> StableCoordinates::try_rig(const Eigen::VectorXd& delta) const {
  if (is_tangent_) return in_tangent(mean_, delta);
  MovedRig moved{mean_, Eigen::Matrix3d::Identity(), Eigen::Vector3d::Zero()};
  for (std::size_t c = 0; c < mean_.cameras.size(); ++c) {
    const Eigen::VectorXd intrinsics = intrinsics_of(mean_, delta, c);
    auto turned = cameras_[c].camera(intrinsics);
    if (!turned) return std::nullopt;
    moved.rig.cameras[c] = std::move(turned->camera);
    const Eigen::Vector3d v = cameras_[c].linear_turn(intrinsics);
    if (c == 0) {
      moved.turn = turned->turn;
      moved.linear_turn = v;
      continue;
    }
    const Pose& mean = mean_.T_camera_first[c];
    const auto tangent = delta.segment<6>(pose_index(mean_, static_cast<int>(c)));
    const Eigen::Vector3d rho = tangent.head<3>() - v + mean.R * moved.linear_turn;
    Pose& T = moved.rig.T_camera_first[c];
    T.R = turned->turn * rotation_from_vector(rho) * mean.R * moved.turn.transpose();
    T.t = turned->turn * (mean.t + tangent.tail<3>() - v.cross(mean.t));
  }
  return moved;
}

MovedRig StableCoordinates::rig(const Eigen::VectorXd& delta) const {
  if (auto moved = try_rig(delta)) return *std::move(moved);
  return in_tangent(mean_, delta);
}

std::optional<StablePosition> StableCoordinates::try_position(const Rig& rig) const {
  StablePosition at = tangent_position(rig, mean_);
  if (is_tangent_) return at;
  std::optional<StableCamera::Coordinates> first;
  Eigen::Vector3d first_linear;
  Eigen::Matrix3Xd first_linear_by;
  for (std::size_t c = 0; c < mean_.cameras.size(); ++c) {
    const auto found = cameras_[c].coordinates(rig.cameras[c]);
    if (!found) return std::nullopt;
    const int i = intrinsics_index(mean_, static_cast<int>(c));
    const auto n = found->stable.size();
    at.delta.segment(i, n) = found->stable;
    at.by_rig.block(i, i, n, n) = found->by_intrinsics;
    const Eigen::Vector3d v = cameras_[c].linear_turn(found->stable);
    const Eigen::Matrix3Xd v_by = cameras_[c].linear_turn_by_intrinsics() * found->by_intrinsics;
    if (c == 0) {
      first = found;
      first_linear = v;
      first_linear_by = v_by;
      continue;
    }
    const int p = pose_index(mean_, static_cast<int>(c));
    const Pose &mean = mean_.T_camera_first[c], &T = rig.T_camera_first[c];
    const Eigen::Matrix3d back = found->turn.transpose();
    const Eigen::Vector3d rho = vector_from_rotation(back * T.R * first->turn * mean.R.transpose());
    at.delta.segment<3>(p) = rho + v - mean.R * first_linear;
    at.delta.segment<3>(p + 3) = back * T.t - mean.t + v.cross(mean.t);

    // exp([ρ]) = V_cᵀ R V_0 R̄ᵀ and t* = V_cᵀ t, by the pose, the turns and their linear parts.
    const Eigen::Matrix3d J = left_jacobian(rho).inverse();
    const auto n_first = first->stable.size();
    at.by_rig.block(p, 0, 3, n_first) =
        J * back * T.R * first->turn_by_intrinsics - mean.R * first_linear_by;
    at.by_rig.block(p, i, 3, n) = v_by - J * back * found->turn_by_intrinsics;
    at.by_rig.block<3, 3>(p, p) = J * back;
    at.by_rig.block(p + 3, i, 3, n) =
        back * hat(T.t) * found->turn_by_intrinsics - hat(mean.t) * v_by;
    at.by_rig.block<3, 3>(p + 3, p + 3) = back;
  }
  return at;
}

std::optional<Eigen::VectorXd> StableCoordinates::try_coordinates(const Rig& rig) const {
  auto at = try_position(rig);
  if (!at) return std::nullopt;
  return std::move(at->delta);
}

Eigen::VectorXd StableCoordinates::coordinates(const Rig& rig) const {
  if (auto delta = try_coordinates(rig)) return *std::move(delta);
  return difference(rig, mean_);
}

}  // namespace vernier::internal
