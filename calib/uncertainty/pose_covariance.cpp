// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/uncertainty/pose_covariance.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>

#include "calib/estimate/stable_coordinates.h"
#include "calib/pose.h"
#include "calib/rig_and_boards.h"
#include "calib/statistics/draw_sources.h"
#include "calib/statistics/random.h"
#include "calib/uncertainty/joint_information.h"

namespace vernier::internal {
namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// M with M δ_f = (ω_f, τ_f + t_f × ω_f) / frames.
Matrix6 motion_at_origin(const Pose& T_first_board, double frames) {
  Matrix6 M = Matrix6::Identity();
  M.bottomLeftCorner<3, 3>() = hat(T_first_board.t);
  return M / frames;
}

/// Derivative of frame f's pose by the rig with the warp carried along.
Eigen::Matrix<double, 6, Eigen::Dynamic> total_by_rig(const ConditionalBoardPoses& given,
                                                      std::size_t f) {
  return given.frames[f].by_rig + given.frames[f].by_warp * given.warp_by_rig;
}

/// [C, C Kᵀ; K C, K C Kᵀ + own] for y = K a + ε, Cov ε = own.
Eigen::MatrixXd chained(const Eigen::MatrixXd& C,
                        const Eigen::MatrixXd& K,
                        const Eigen::MatrixXd& own) {
  const auto n = C.rows(), m = K.rows();
  Eigen::MatrixXd joint(n + m, n + m);
  joint.topLeftCorner(n, n) = C;
  joint.bottomLeftCorner(m, n) = K * C;
  joint.topRightCorner(n, m) = joint.bottomLeftCorner(m, n).transpose();
  const Eigen::MatrixXd lower = joint.bottomLeftCorner(m, n) * K.transpose() + own;
  joint.bottomRightCorner(m, m) = 0.5 * (lower + lower.transpose());
  return joint;
}

}  // namespace

Eigen::MatrixXd rig_and_motion_covariance(const RigAndBoards& joint) {
  const ConditionalBoardPoses& given = *joint.given_rig;
  const auto n = joint.rig_covariance.rows();
  const auto frames = static_cast<double>(given.frames.size());
  Eigen::MatrixXd by_rig = Eigen::MatrixXd::Zero(6, n);
  Eigen::Matrix<double, 6, 2> by_warp = Eigen::Matrix<double, 6, 2>::Zero();
  Matrix6 own = Matrix6::Zero();
  for (std::size_t f = 0; f < given.frames.size(); ++f) {
    const Matrix6 M = motion_at_origin(joint.T_first_board[f], frames);
    by_rig += M * given.frames[f].by_rig;
    by_warp += M * given.frames[f].by_warp;
    const Matrix6 half = M * given.frames[f].factor;
    own += half * half.transpose();
  }
  by_rig += by_warp * given.warp_by_rig;
  const Eigen::Matrix<double, 6, 2> half = by_warp * given.warp_factor;
  own += half * half.transpose();
  return chained(joint.rig_covariance, by_rig, std::pow(joint.board_sigma_px, 2) * own);
}

Eigen::MatrixXd rig_and_poses_covariance(const RigAndBoards& joint) {
  const ConditionalBoardPoses& given = *joint.given_rig;
  const auto frames = static_cast<Eigen::Index>(given.frames.size());
  Eigen::MatrixXd K(6 * frames, joint.rig_covariance.rows()), W(6 * frames, 2);
  Eigen::MatrixXd own = Eigen::MatrixXd::Zero(6 * frames, 6 * frames);
  for (Eigen::Index f = 0; f < frames; ++f) {
    const auto& frame = given.frames[static_cast<std::size_t>(f)];
    K.middleRows<6>(6 * f) = total_by_rig(given, static_cast<std::size_t>(f));
    W.middleRows<6>(6 * f) = frame.by_warp * given.warp_factor;
    own.block<6, 6>(6 * f, 6 * f) = frame.factor * frame.factor.transpose();
  }
  own += W * W.transpose();
  return chained(joint.rig_covariance, K, std::pow(joint.board_sigma_px, 2) * own);
}

MeanBoardMap sample_board_map(const RigAndBoards& joint,
                              const Eigen::VectorXd& rig_deviation,
                              const MovedRig& moved,
                              double psi_c,
                              std::uint64_t seed,
                              std::uint32_t trial) {
  const ConditionalBoardPoses& given = *joint.given_rig;
  const auto place = [&](int feature) {
    return RandomCounter{.seed = seed,
                         .trial = trial,
                         .feature = static_cast<std::uint32_t>(feature),
                         .source = static_cast<std::uint32_t>(DrawSource::monte_carlo)};
  };
  const double sigma = psi_c * joint.board_sigma_px;
  const Eigen::Vector2d z_warp = RandomStream(place(-1)).normals(2);
  const Eigen::Vector2d warp =
      given.warp_by_rig * rig_deviation + sigma * given.warp_factor * z_warp;
  MeanBoardMap map{Eigen::Matrix3d::Zero(), Eigen::Vector3d::Zero()};
  for (std::size_t f = 0; f < given.frames.size(); ++f) {
    const auto& frame = given.frames[f];
    const Eigen::Matrix<double, 6, 1> z = RandomStream(place(joint.frames[f])).normals(6);
    Eigen::Matrix<double, 6, 1> delta =
        frame.by_rig * rig_deviation + frame.by_warp * warp + sigma * frame.factor * z;
    const Pose& told = joint.T_first_board[f];
    delta.head<3>() -= moved.linear_turn;
    delta.tail<3>() -= moved.linear_turn.cross(told.t);
    const Pose motion = retract(told, delta) * told.inverse();
    map.A += motion.R;
    map.b += motion.t;
  }
  const auto frames = static_cast<double>(given.frames.size());
  return {moved.turn * map.A / frames, moved.turn * map.b / frames};
}

}  // namespace vernier::internal
