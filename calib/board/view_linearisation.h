// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include <vector>

#include "calib/board_observations.h"
#include "calib/camera.h"
#include "calib/pose.h"

namespace vernier::internal {

/// Reprojection residuals r = project(T_camera_first T_first_board X) - q of one board view and
/// their derivatives with respect to the intrinsics and the left tangents of both poses. Rows
/// alternate u, v; pixels.
struct ViewLinearisation {
  Eigen::VectorXd residual_px;                                      ///< 2n
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic> by_camera;  ///< 2n x intrinsics
  Eigen::Matrix<double, Eigen::Dynamic, 6> by_camera_pose;          ///< 2n x 6, of T_camera_first
  Eigen::Matrix<double, Eigen::Dynamic, 6> by_board_pose;           ///< 2n x 6, of T_first_board
  Eigen::Matrix<double, Eigen::Dynamic, 2> by_warp;                 ///< 2n x 2, if shapes are given
};

/// Whether derivatives are wanted as well.
enum class Linearise { residual_only, with_jacobian };

/// Used by the normal equations, the refined minimum and the fit of a single board's pose, which
/// need every row. The Ceres cost and the re-solver evaluate the formulas of
/// calib/camera/corner_formulas.inc on many views at once (calib/solver/view_kernel.h) and keep
/// only their sums. `target_m` includes the board's warp; with `shapes` (calib/board/board_warp.h)
/// the derivative with respect to the warp is computed too.
void linearise_view(const Camera& camera,
                    const Pose& T_camera_first,
                    const Pose& T_first_board,
                    const std::vector<Eigen::Vector3d>& target_m,
                    const BoardView& view,
                    Linearise what,
                    ViewLinearisation& out,
                    const Eigen::Matrix<double, Eigen::Dynamic, 2>* shapes = nullptr);

}  // namespace vernier::internal
