// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/uncertainty/joint_information.h"

#include <Eigen/Cholesky>

#include <cstddef>
#include <utility>
#include <vector>

#include "calib/base/decompositions.h"
#include "calib/board/board_warp.h"
#include "calib/board/view_linearisation.h"
#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/noise/corner_covariance.h"
#include "calib/noise/corner_noise.h"
#include "calib/noise/frame_rows.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "calib/solver/pose_factor.h"

namespace vernier::internal {
namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// Products of one frame's derivatives: rig (A), pose (B), warp (W).
struct Products {
  Eigen::Matrix<double, 6, Eigen::Dynamic> BA;
  Eigen::Matrix<double, 6, 2> BW = Eigen::Matrix<double, 6, 2>::Zero();
  Matrix6 BB = Matrix6::Zero();
  Eigen::Matrix<double, 2, Eigen::Dynamic> WA;
  Eigen::Matrix2d WW = Eigen::Matrix2d::Zero();

  explicit Products(Eigen::Index n) : BA(6, n), WA(2, n) {
    BA.setZero();
    WA.setZero();
  }
};

void add_view(const ViewLinearisation& J, int intrinsics, int pose, Products& p) {
  const auto& W = J.by_warp;
  const auto count = J.by_camera.cols();
  p.BA.middleCols(intrinsics, count) += J.by_board_pose.transpose() * J.by_camera;
  p.BB += J.by_board_pose.transpose() * J.by_board_pose;
  p.BW += J.by_board_pose.transpose() * W;
  p.WW += W.transpose() * W;
  p.WA.middleCols(intrinsics, count) += W.transpose() * J.by_camera;
  if (pose < 0) return;  // the first camera has no pose
  p.BA.middleCols<6>(pose) += J.by_board_pose.transpose() * J.by_camera_pose;
  p.WA.middleCols<6>(pose) += W.transpose() * J.by_camera_pose;
}

/// L with L Lᵀ = C⁻¹, C = K Kᵀ: L = K⁻ᵀ.
template <int N>
Eigen::Matrix<double, N, N> inverse_factor(const Eigen::LLT<Eigen::Matrix<double, N, N>>& C) {
  return C.matrixU().solve(Eigen::Matrix<double, N, N>::Identity());
}

/// The conditional poses, frame by frame.
class ConditionalPoses {
 public:
  explicit ConditionalPoses(Eigen::Index parameters)
      : S_wa_(Eigen::MatrixXd::Zero(2, parameters)), S_ww_(Eigen::Matrix2d::Zero()) {}

  void add(const Products& p, int frame) {
    const Eigen::LLT<Matrix6> C = pose_factor(p.BB, frame);
    result_.frames.push_back({-C.solve(p.BA), -C.solve(p.BW), inverse_factor<6>(C)});
    S_wa_ += p.WA + p.BW.transpose() * result_.frames.back().by_rig;
    S_ww_ += p.WW + p.BW.transpose() * result_.frames.back().by_warp;
  }

  ConditionalBoardPoses result(BoardWarp warp_is) {
    result_.warp_by_rig = Eigen::MatrixXd::Zero(2, S_wa_.cols());
    result_.warp_factor.setZero();
    const Eigen::LLT<Eigen::Matrix2d> warp(S_ww_);
    if (warp_is == BoardWarp::free && warp.info() == Eigen::Success) {
      result_.warp_by_rig = -warp.solve(S_wa_);
      result_.warp_factor = inverse_factor<2>(warp);
    }
    return std::move(result_);
  }

 private:
  ConditionalBoardPoses result_;
  Eigen::Matrix<double, 2, Eigen::Dynamic> S_wa_;
  Eigen::Matrix2d S_ww_;
};

/// The products of the rows of one frame, the derivatives by the warp among those by the rig, with
/// V = K Kᵀ: of K⁻¹ A, K⁻¹ B, K⁻¹ W.
Products whitened_products(const FrameRows& rows, const Eigen::MatrixXd& V, Eigen::Index n) {
  const Cholesky K(V);
  const Eigen::MatrixXd B = K.solve_lower(Eigen::MatrixXd(rows.by_pose));
  const Eigen::MatrixXd AW = K.solve_lower(rows.by_rig);
  Products p(n);
  p.BB = B.transpose() * B;
  p.BA = B.transpose() * AW.leftCols(n);
  if (AW.cols() == n) return p;
  const Eigen::MatrixXd W = AW.rightCols<2>();
  p.BW = B.transpose() * W;
  p.WW = W.transpose() * W;
  p.WA = W.transpose() * AW.leftCols(n);
  return p;
}

}  // namespace

ConditionalBoardPoses conditional_board_poses(const BoardObservations& observations,
                                              const BoardState& state) {
  const auto n = parameter_count(state.rig);
  const std::vector<Eigen::Vector3d> target_m = warped_target(observations.target_m, state.warp_m);
  const auto shapes = warp_shapes(observations.target_m);
  ConditionalPoses poses(n);
  auto view = observations.views.begin();
  ViewLinearisation J;
  for (std::size_t f = 0; f < state.frames.size(); ++f) {
    Products p(n);
    for (; view != observations.views.end() && view->frame == state.frames[f]; ++view) {
      const int c = view->camera;
      linearise_view(state.rig.cameras[c], state.rig.T_camera_first[c], state.T_first_board[f],
                     target_m, *view, Linearise::with_jacobian, J, &shapes);
      add_view(J, intrinsics_index(state.rig, c), c == 0 ? -1 : pose_index(state.rig, c), p);
    }
    poses.add(p, state.frames[f]);
  }
  return poses.result(state.warp_m.isZero(0) ? BoardWarp::known : BoardWarp::free);
}

ConditionalBoardPoses conditional_board_poses(const BoardObservations& observations,
                                              const BoardState& state,
                                              const CalibrationEffects& effects,
                                              double pixel_sigma_px) {
  const auto n = parameter_count(state.rig);
  const BoardWarp warp = effects.shape_m.empty() ? BoardWarp::known : BoardWarp::free;
  BoardObservations shaped = observations;
  for (std::size_t i = 0; i < effects.shape_m.size(); ++i) shaped.target_m[i] += effects.shape_m[i];
  BoardState unwarped = state;  // the shape contains the warp
  if (warp == BoardWarp::free) unwarped.warp_m.setZero();
  const Eigen::MatrixXd all = Eigen::MatrixXd::Identity(n, n);
  ConditionalPoses poses(n);
  for (const FrameRows& rows : frame_rows(shaped, unwarped, all, warp)) {
    const Eigen::MatrixXd V = corner_covariance(rows, noise_of(effects), observations.target_m);
    poses.add(whitened_products(rows, V / (pixel_sigma_px * pixel_sigma_px), n), rows.frame);
  }
  return poses.result(warp);
}

}  // namespace vernier::internal
