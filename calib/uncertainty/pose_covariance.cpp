// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/pose_covariance.h"

#include <algorithm>
#include <cmath>

#include "calib/draw_sources.h"
#include "calib/error.h"
#include "calib/random.h"
#include "calib/scaled_root.h"

namespace vernier {
namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// How many of the parameters the views determine, tr(C_bound S): all that have a variance, but for
/// what a prior knows of them.
double data_parameters(const RigEstimate& estimate, double directions) {
  const CalibrationEvidence& evidence = *estimate.evidence;
  if (estimate.calibration->prior_dof == 0) return directions;
  const ReducedNormalEquations equations = reduced_normal_equations(
      evidence.observations,
      {estimate.rig, evidence.frames, evidence.T_first_board, evidence.warp_m},
      estimate.calibration->pixel_sigma_px,
      evidence.warp_m.isZero(0) ? BoardWarp::known : BoardWarp::free);
  return (*estimate.covariance_mvb * equations.information).trace();
}

/// φ above.
double mean_inflation(const RigEstimate& estimate) {
  const ScaledRoot bound(*estimate.covariance_mvb);
  const auto p = static_cast<double>(bound.white.rows());
  const double d = data_parameters(estimate, p);
  if (!(d > 1e-3)) return 1;  // the views say nothing: there is nothing to inflate
  const double trace =
      (bound.white * estimate.covariance->matrix * bound.white.transpose()).trace();
  return std::max(0.0, (trace - (p - d)) / d);
}

/// M with M δ_f = (ω_f, τ_f + t_f × ω_f) / frames.
Matrix6 motion_at_origin(const Pose& T_first_board, double frames) {
  Matrix6 M = Matrix6::Identity();
  M.bottomLeftCorner<3, 3>() = hat(T_first_board.t);
  return M / frames;
}

/// Derivative of frame f's pose by the rig with the warp carried along.
Eigen::Matrix<double, 6, Eigen::Dynamic> total_by_rig(const BoardPosesGivenRig& given,
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

RigAndBoards rig_and_boards(const RigEstimate& estimate,
                            CovarianceChoice choice,
                            const std::string& place) {
  if (!estimate.evidence || estimate.evidence->observations.views.empty()) {
    throw Error(place, "it holds no views of a board, so the poses of the board are unknown",
                "calibrate from views of a board, without --no-evidence");
  }
  if (!estimate.calibration || !(estimate.calibration->pixel_sigma_px > 0)) {
    throw Error(place, "its pixel noise is unknown", "give calibration.pixel_sigma_px above 0");
  }
  const CalibrationEvidence& evidence = *estimate.evidence;
  RigAndBoards joint;
  joint.rig = estimate.rig;
  joint.frames = evidence.frames;
  joint.T_first_board = evidence.T_first_board;
  joint.rig_covariance = required_covariance(estimate, choice, place).matrix;
  joint.given_rig = board_poses_given_rig(
      evidence.observations,
      {estimate.rig, evidence.frames, evidence.T_first_board, evidence.warp_m});
  double inflation = 1;
  if (choice == CovarianceChoice::honest && estimate.covariance_mvb &&
      estimate.covariance->kind != CovarianceKind::mvb) {
    inflation = mean_inflation(estimate);
  }
  joint.board_sigma_px = estimate.calibration->pixel_sigma_px * std::sqrt(inflation);
  return joint;
}

Eigen::MatrixXd rig_and_motion_covariance(const RigAndBoards& joint) {
  const BoardPosesGivenRig& given = joint.given_rig;
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
  const BoardPosesGivenRig& given = joint.given_rig;
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
                              double psi_c,
                              std::uint64_t seed,
                              std::uint32_t trial) {
  const BoardPosesGivenRig& given = joint.given_rig;
  const auto place = [&](int feature) {
    return DrawPlace{.seed = seed,
                     .trial = trial,
                     .feature = static_cast<std::uint32_t>(feature),
                     .source = static_cast<std::uint32_t>(DrawSource::monte_carlo)};
  };
  const double sigma = psi_c * joint.board_sigma_px;
  const Eigen::Vector2d z_warp = Draws(place(-1)).normals(2);
  const Eigen::Vector2d warp =
      given.warp_by_rig * rig_deviation + sigma * given.warp_factor * z_warp;
  MeanBoardMap map{Eigen::Matrix3d::Zero(), Eigen::Vector3d::Zero()};
  for (std::size_t f = 0; f < given.frames.size(); ++f) {
    const auto& frame = given.frames[f];
    const Eigen::Matrix<double, 6, 1> z = Draws(place(joint.frames[f])).normals(6);
    const Eigen::Matrix<double, 6, 1> delta =
        frame.by_rig * rig_deviation + frame.by_warp * warp + sigma * frame.factor * z;
    const Pose moved = retract(joint.T_first_board[f], delta) * joint.T_first_board[f].inverse();
    map.A += moved.R;
    map.b += moved.t;
  }
  const auto frames = static_cast<double>(given.frames.size());
  return {map.A / frames, map.b / frames};
}

}  // namespace vernier
