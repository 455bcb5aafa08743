// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/board/view_linearisation.h"

#include <vector>

#include "calib/board_observations.h"
#include "calib/camera.h"
#include "calib/pose.h"

namespace vernier::internal {

void linearise_view(const Camera& camera,
                    const Pose& T_camera_first,
                    const Pose& T_first_board,
                    const std::vector<Eigen::Vector3d>& target_m,
                    const BoardView& view,
                    Linearise what,
                    ViewLinearisation& out,
                    const Eigen::Matrix<double, Eigen::Dynamic, 2>* shapes) {
  const auto n = static_cast<Eigen::Index>(view.ids.size());
  out.residual_px.resize(2 * n);
  const bool derive = what == Linearise::with_jacobian;
  if (derive) {
    out.by_camera.resize(2 * n, camera.parameters.size());
    out.by_camera_pose.resize(2 * n, 6);
    out.by_board_pose.resize(2 * n, 6);
    if (shapes) out.by_warp.resize(2 * n, 2);
  }
  ProjectionJacobian J;
  for (Eigen::Index i = 0; i < n; ++i) {
    const Eigen::Vector3d turned = T_first_board.R * target_m[view.ids[i]];  // R_b X
    const Eigen::Vector3d x_first = turned + T_first_board.t;
    const Eigen::Vector3d seen = T_camera_first.R * x_first;
    const Eigen::Vector3d x = seen + T_camera_first.t;
    if (!derive) {
      out.residual_px.segment<2>(2 * i) = project(camera, x) - view.pixels_px[i];
      continue;
    }
    out.residual_px.segment<2>(2 * i) = project(camera, x, J) - view.pixels_px[i];
    out.by_camera.middleRows<2>(2 * i) = J.camera;
    // d(exp(w) R x)/dw = -[R x]x at w = 0
    out.by_camera_pose.block<2, 3>(2 * i, 0).noalias() = -J.point * hat(seen);
    out.by_camera_pose.block<2, 3>(2 * i, 3) = J.point;
    const Eigen::Matrix<double, 2, 3> by_first = J.point * T_camera_first.R;
    out.by_board_pose.block<2, 3>(2 * i, 0).noalias() = -by_first * hat(turned);
    out.by_board_pose.block<2, 3>(2 * i, 3) = by_first;
    if (shapes) {
      out.by_warp.middleRows<2>(2 * i).noalias() =
          (by_first * T_first_board.R.col(2)) * shapes->row(view.ids[i]);
    }
  }
}

}  // namespace vernier::internal
