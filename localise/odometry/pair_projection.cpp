// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/odometry/pair_projection.h"

#include "calib/camera.h"
#include "calib/pose.h"
#include "calib/rig.h"

namespace vernier::localise::internal {

bool PairProjector::project(const Eigen::Vector3d& x_m, PairPixels& pixels, PairByPoint& by_point) {
  const Pose& T = rig_.T_camera_first[1];
  constexpr double nearest_m = 1e-3;  // nearer, its pixel is far outside any image
  in_right_m_ = T * x_m;
  if (!(x_m.z() > nearest_m) || !(in_right_m_.z() > nearest_m)) return false;
  pixels.head<2>() = vernier::project(rig_.cameras[0], x_m, left_);
  pixels.tail<2>() = vernier::project(rig_.cameras[1], in_right_m_, right_);
  by_point.topRows<2>() = left_.point;
  by_point.bottomRows<2>().noalias() = right_.point * T.R;
  return pixels.allFinite() && by_point.allFinite();
}

Eigen::Matrix<double, 4, Eigen::Dynamic> PairProjector::by_rig() const {
  using Eigen::MatrixXd;
  MatrixXd J = MatrixXd::Zero(4, parameter_count(rig_));
  J.block(0, 0, 2, left_.camera.cols()) = left_.camera;
  J.block(2, intrinsics_index(rig_, 1), 2, right_.camera.cols()) = right_.camera;
  // y = exp(w) R x + t + τ: δy = −[R x]x w + τ
  const int pose = pose_index(rig_, 1);
  J.block<2, 3>(2, pose) = -right_.point * hat(in_right_m_ - rig_.T_camera_first[1].t);
  J.block<2, 3>(2, pose + 3) = right_.point;
  return J;
}

}  // namespace vernier::localise::internal
