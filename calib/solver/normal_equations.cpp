// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/solver/normal_equations.h"

#include <Eigen/Cholesky>
#include <algorithm>

#include "calib/board/board_warp.h"
#include "calib/board/view_linearisation.h"
#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/error.h"
#include "calib/rig.h"
#include "calib/solver/pose_factor.h"

namespace vernier::internal {
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

void add_warp(const ViewLinearisation& J, int intrinsics, int pose, double weight, FrameBlocks& f) {
  const auto w = f.A.rows() - 2;
  const auto cross = [&](const auto& by, Eigen::Index row) {
    const Eigen::MatrixXd block = weight * by.transpose() * J.by_warp;
    f.A.block(row, w, block.rows(), 2) += block;
    f.A.block(w, row, 2, block.rows()) += block.transpose();
  };
  cross(J.by_camera, intrinsics);
  if (pose >= 0) cross(J.by_camera_pose, pose);
  f.A.bottomRightCorner<2, 2>() += weight * J.by_warp.transpose() * J.by_warp;
  f.B.bottomRows<2>() += weight * J.by_warp.transpose() * J.by_board_pose;
  f.a.tail<2>() += weight * J.by_warp.transpose() * J.residual_px;
}

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

/// Adds the frame's term with its board pose eliminated.
void add_frame(const FrameBlocks& blocks, int frame, int index, ReducedNormalEquations& sum) {
  const auto C = pose_factor(blocks.C, frame);
  const Eigen::Matrix<double, 6, Eigen::Dynamic> half =
      C.matrixL().solve(blocks.B.transpose());  // L⁻¹ BᵀA
  sum.held_poses_diagonal += blocks.A.diagonal();
  sum.frame_information.emplace_back(blocks.A);
  sum.frame_information.back().noalias() -= half.transpose() * half;
  sum.information += sum.frame_information.back();
  const Eigen::Matrix<double, 6, 1> half_b = C.matrixL().solve(blocks.b);
  sum.scores.col(index) = blocks.a - half.transpose() * half_b;
}

/// The equations under the linear map of unknowns a = M z: MᵀSM, Mᵀg.
ReducedNormalEquations mapped(const ReducedNormalEquations& equations, const Eigen::MatrixXd& M) {
  ReducedNormalEquations result = equations;
  result.information = M.transpose() * equations.information * M;
  result.scores = M.transpose() * equations.scores;
  for (Eigen::MatrixXd& S : result.frame_information) S = (M.transpose() * S * M).eval();
  if (equations.prior_information.size() > 0) {
    result.prior_information = M.transpose() * equations.prior_information * M;
  }
  return result;
}

/// The equations with the warp's unknowns last if it is free.
ReducedNormalEquations sum_of_frames(const BoardObservations& observations,
                                     const BoardState& state,
                                     double pixel_sigma_px,
                                     BoardWarp warp) {
  const bool warps = warp == BoardWarp::free;
  const int n = parameter_count(state.rig) + (warps ? 2 : 0);
  const std::vector<Eigen::Vector3d> target_m = warped_target(observations.target_m, state.warp_m);
  const auto shapes = warp_shapes(observations.target_m);
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
                     target_m, *view, Linearise::with_jacobian, J, warps ? &shapes : nullptr);
      const int intrinsics = intrinsics_index(state.rig, c);
      const int pose = c == 0 ? -1 : pose_index(state.rig, c);
      add_view(J, intrinsics, pose, weight, blocks);
      if (warps) add_warp(J, intrinsics, pose, weight, blocks);
      result.frame_chi2[f] += weight * J.residual_px.squaredNorm();
      result.residuals += static_cast<int>(J.residual_px.size());
    }
    add_frame(blocks, state.frames[f], f, result);
    result.chi2 += result.frame_chi2[f];
  }
  return result;
}

}  // namespace

ReducedNormalEquations reduced_normal_equations(const BoardObservations& observations,
                                                const BoardState& state,
                                                double pixel_sigma_px,
                                                BoardWarp warp) {
  ReducedNormalEquations sum = sum_of_frames(observations, state, pixel_sigma_px, warp);
  return warp == BoardWarp::free ? without_warp(sum) : sum;
}

ReducedNormalEquations equations_with_warp(const BoardObservations& observations,
                                           const BoardState& state,
                                           double pixel_sigma_px) {
  return sum_of_frames(observations, state, pixel_sigma_px, BoardWarp::free);
}

ReducedNormalEquations without_warp(const ReducedNormalEquations& equations) {
  const auto p = equations.information.rows() - 2;
  const Eigen::LLT<Eigen::Matrix2d> W(equations.information.bottomRightCorner<2, 2>());
  if (W.info() != Eigen::Success) {
    throw Error("board warp", "the views do not constrain it", "do not estimate it");
  }
  Eigen::MatrixXd M(p + 2, p);  // a = M z = [I; -W⁻¹ X] z, with W the warp's block of S
  M.topRows(p).setIdentity();
  M.bottomRows<2>() = -W.solve(equations.information.bottomLeftCorner(2, p));
  ReducedNormalEquations result = mapped(equations, M);
  result.held_poses_diagonal.conservativeResize(p);
  return result;
}

ReducedNormalEquations restricted(const ReducedNormalEquations& equations,
                                  const Eigen::MatrixXd& E) {
  ReducedNormalEquations result = mapped(equations, E);
  result.held_poses_diagonal =
      E.cwiseAbs2().transpose() * equations.held_poses_diagonal;  // exact if columns are axes
  return result;
}

void add_prior(ReducedNormalEquations& equations, const Eigen::MatrixXd& information) {
  if (equations.prior_information.size() == 0) {
    equations.prior_information = Eigen::MatrixXd::Zero(information.rows(), information.cols());
  }
  equations.prior_information += information;
  equations.information += information;
  equations.held_poses_diagonal += information.diagonal();
}

ReducedNormalEquations rescaled(ReducedNormalEquations equations, double pixel_sigma_ratio) {
  const double weight = 1 / (pixel_sigma_ratio * pixel_sigma_ratio);
  equations.information *= weight;
  equations.held_poses_diagonal *= weight;
  equations.scores *= weight;
  for (Eigen::MatrixXd& S : equations.frame_information) S *= weight;
  equations.chi2 *= weight;
  for (double& chi2 : equations.frame_chi2) chi2 *= weight;
  return equations;
}

}  // namespace vernier::internal
