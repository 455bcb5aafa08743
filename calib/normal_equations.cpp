// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/normal_equations.h"

#include <Eigen/Cholesky>
#include <algorithm>

#include "calib/error.h"
#include "calib/view_linearisation.h"

namespace vernier {
namespace {

/// Sums over the views of one frame.
struct FrameBlocks {
  Eigen::MatrixXd A;                           // AᵀA
  Eigen::Matrix<double, Eigen::Dynamic, 6> B;  // AᵀB
  Eigen::Matrix<double, 6, 6> C;               // BᵀB
  Eigen::VectorXd a;                           // Aᵀr
  Eigen::Matrix<double, 6, 1> b;               // Bᵀr

  explicit FrameBlocks(int n)
      : A(Eigen::MatrixXd::Zero(n, n)),
        B(n, 6),
        C(Eigen::Matrix<double, 6, 6>::Zero()),
        a(Eigen::VectorXd::Zero(n)),
        b(Eigen::Matrix<double, 6, 1>::Zero()) {
    B.setZero();
  }
};

void add_view(const ViewLinearisation& J, int intrinsics, int pose, double weight, FrameBlocks& f) {
  const auto p = J.by_camera.cols();
  f.A.block(intrinsics, intrinsics, p, p) += weight * J.by_camera.transpose() * J.by_camera;
  f.B.middleRows(intrinsics, p) += weight * J.by_camera.transpose() * J.by_board_pose;
  f.C += weight * J.by_board_pose.transpose() * J.by_board_pose;
  f.a.segment(intrinsics, p) += weight * J.by_camera.transpose() * J.residual_px;
  f.b += weight * J.by_board_pose.transpose() * J.residual_px;
  if (pose < 0) return;  // the first camera has no pose
  const Eigen::MatrixXd cross = weight * J.by_camera.transpose() * J.by_camera_pose;
  f.A.block(intrinsics, pose, p, 6) += cross;
  f.A.block(pose, intrinsics, 6, p) += cross.transpose();
  f.A.block<6, 6>(pose, pose) += weight * J.by_camera_pose.transpose() * J.by_camera_pose;
  f.B.middleRows<6>(pose) += weight * J.by_camera_pose.transpose() * J.by_board_pose;
  f.a.segment<6>(pose) += weight * J.by_camera_pose.transpose() * J.residual_px;
}

}  // namespace

ReducedNormalEquations reduced_normal_equations(const BoardObservations& observations,
                                                const BoardState& state,
                                                double pixel_sigma_px) {
  const int n = parameter_count(state.rig);
  const auto frames = static_cast<int>(state.frames.size());
  const double weight = 1 / (pixel_sigma_px * pixel_sigma_px);
  ReducedNormalEquations result;
  result.information = Eigen::MatrixXd::Zero(n, n);
  result.held_poses_diagonal = Eigen::VectorXd::Zero(n);
  result.scores = Eigen::MatrixXd::Zero(n, frames);
  result.frame_chi2.assign(frames, 0);

  auto view = observations.views.begin();
  ViewLinearisation J;
  for (int f = 0; f < frames; ++f) {
    FrameBlocks blocks(n);
    for (; view != observations.views.end() && view->frame == state.frames[f]; ++view) {
      const int c = view->camera;
      linearise_view(state.rig.cameras[c], state.rig.T_camera_first[c], state.T_first_board[f],
                     observations.target_m, *view, Linearise::with_jacobian, J);
      add_view(J, intrinsics_index(state.rig, c), c == 0 ? -1 : pose_index(state.rig, c), weight,
               blocks);
      result.frame_chi2[f] += weight * J.residual_px.squaredNorm();
      result.residuals += static_cast<int>(J.residual_px.size());
    }
    const Eigen::LLT<Eigen::Matrix<double, 6, 6>> C(blocks.C);
    if (C.info() != Eigen::Success) {
      throw Error("frame " + std::to_string(state.frames[f]),
                  "its corners do not fix the pose of the board", "leave the frame out");
    }
    const Eigen::Matrix<double, 6, Eigen::Dynamic> half =
        C.matrixL().solve(blocks.B.transpose());  // L⁻¹ BᵀA
    result.held_poses_diagonal += blocks.A.diagonal();
    result.frame_information.emplace_back(blocks.A);
    result.frame_information.back().noalias() -= half.transpose() * half;
    result.information += result.frame_information.back();
    const Eigen::Matrix<double, 6, 1> half_b = C.matrixL().solve(blocks.b);
    result.scores.col(f) = blocks.a - half.transpose() * half_b;
    result.chi2 += result.frame_chi2[f];
  }
  return result;
}

}  // namespace vernier
