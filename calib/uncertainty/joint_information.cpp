// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/uncertainty/joint_information.h"

#include <Eigen/Cholesky>

#include <cstddef>
#include <vector>

#include "calib/board/board_warp.h"
#include "calib/board/view_linearisation.h"
#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/rig.h"
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

}  // namespace

ConditionalBoardPoses conditional_board_poses(const BoardObservations& observations,
                                              const BoardState& state) {
  const auto n = parameter_count(state.rig);
  const std::vector<Eigen::Vector3d> target_m = warped_target(observations.target_m, state.warp_m);
  const auto shapes = warp_shapes(observations.target_m);
  ConditionalBoardPoses result;
  Eigen::Matrix<double, 2, Eigen::Dynamic> S_wa = Eigen::MatrixXd::Zero(2, n);
  Eigen::Matrix2d S_ww = Eigen::Matrix2d::Zero();
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
    const Eigen::LLT<Matrix6> C = pose_factor(p.BB, state.frames[f]);
    result.frames.push_back({-C.solve(p.BA), -C.solve(p.BW), inverse_factor<6>(C)});
    S_wa += p.WA + p.BW.transpose() * result.frames.back().by_rig;
    S_ww += p.WW + p.BW.transpose() * result.frames.back().by_warp;
  }
  result.warp_by_rig = Eigen::MatrixXd::Zero(2, n);
  result.warp_factor.setZero();
  const Eigen::LLT<Eigen::Matrix2d> warp(S_ww);
  if (!state.warp_m.isZero(0) && warp.info() == Eigen::Success) {
    result.warp_by_rig = -warp.solve(S_wa);
    result.warp_factor = inverse_factor<2>(warp);
  }
  return result;
}

}  // namespace vernier::internal
