// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/estimate/stable_coordinates.h"

#include <Eigen/Geometry>
#include <cstddef>
#include <utility>

#include "calib/camera.h"
#include "calib/pose.h"

namespace vernier::internal {
namespace {

/// The part of the tangent that belongs to the intrinsics of a camera.
Eigen::VectorXd intrinsics_of(const Rig& rig, const Eigen::VectorXd& tangent, std::size_t camera) {
  return tangent.segment(intrinsics_index(rig, static_cast<int>(camera)),
                         rig.cameras[camera].parameters.size());
}

}  // namespace

StableCoordinates::StableCoordinates(const Rig& mean, const Eigen::MatrixXd& covariance)
    : mean_(mean) {
  for (std::size_t c = 0; c < mean.cameras.size(); ++c) {
    const auto i = intrinsics_index(mean, static_cast<int>(c));
    const auto n = mean.cameras[c].parameters.size();
    cameras_.emplace_back(mean.cameras[c], covariance.block(i, i, n, n));
    pose_known_.push_back(
        c > 0 &&
        (covariance.diagonal().segment<6>(pose_index(mean, static_cast<int>(c))).array() <= 0)
            .all());
  }
}

std::optional<MovedRig> StableCoordinates::try_rig(const Eigen::VectorXd& delta) const {
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
    if (pose_known_[c]) continue;
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
  return {retract(mean_, delta), Eigen::Matrix3d::Identity(), Eigen::Vector3d::Zero()};
}

std::optional<Eigen::VectorXd> StableCoordinates::try_coordinates(const Rig& rig) const {
  Eigen::VectorXd delta = difference(rig, mean_);
  Eigen::Matrix3d first_turn = Eigen::Matrix3d::Identity();
  Eigen::Vector3d first_linear = Eigen::Vector3d::Zero();
  for (std::size_t c = 0; c < mean_.cameras.size(); ++c) {
    const auto at = cameras_[c].coordinates(rig.cameras[c]);
    if (!at) return std::nullopt;
    delta.segment(intrinsics_index(mean_, static_cast<int>(c)), at->stable.size()) = at->stable;
    const Eigen::Vector3d v = cameras_[c].linear_turn(at->stable);
    if (c == 0) {
      first_turn = at->turn;
      first_linear = v;
      continue;
    }
    if (pose_known_[c]) continue;
    const Pose &mean = mean_.T_camera_first[c], &T = rig.T_camera_first[c];
    auto tangent = delta.segment<6>(pose_index(mean_, static_cast<int>(c)));
    tangent.head<3>() =
        vector_from_rotation(at->turn.transpose() * T.R * first_turn * mean.R.transpose()) + v -
        mean.R * first_linear;
    tangent.tail<3>() = at->turn.transpose() * T.t - mean.t + v.cross(mean.t);
  }
  return delta;
}

Eigen::VectorXd StableCoordinates::coordinates(const Rig& rig) const {
  if (auto delta = try_coordinates(rig)) return *std::move(delta);
  return difference(rig, mean_);
}

}  // namespace vernier::internal
