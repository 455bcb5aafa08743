// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/rectification.h"

#include <Eigen/Geometry>
#include <cmath>
#include <string>

#include "calib/camera.h"
#include "calib/error.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "stereo/segment.h"

namespace vernier::stereo {

Rectification rectification(const Rig& rig) {
  if (rig.cameras.size() != 2) {
    throw Error("rectification", "the rig has " + std::to_string(rig.cameras.size()) + " cameras",
                "use a rig of two cameras");
  }
  const Pose& T = rig.T_camera_first[1];
  const Eigen::Vector3d baseline = -(T.R.transpose() * T.t);  // right centre, left frame
  if (!(baseline.norm() > 1e-3)) {
    throw Error("rectification", "the baseline is shorter than 1 mm", "check the translation");
  }
  const Eigen::Vector3d x = baseline.normalized();
  const Eigen::Vector3d axis = Eigen::Vector3d::UnitZ() + T.R.row(2).transpose();
  const Eigen::Vector3d y = axis.cross(x).normalized();
  Rectification result;
  result.R_rectified_left.row(0) = x;
  result.R_rectified_left.row(1) = y;
  result.R_rectified_left.row(2) = x.cross(y);
  result.R_rectified_right = result.R_rectified_left * T.R.transpose();
  return result;
}

std::optional<double> epipolar_angle_rad(const Rig& rig,
                                         const Rectification& rectification,
                                         const ImageSegment& left) {
  const auto a = try_unproject(rig.cameras[0], left.a_px);
  const auto b = try_unproject(rig.cameras[0], left.b_px);
  if (!a || !b) return std::nullopt;
  const Eigen::Vector3d from = rectification.R_rectified_left * *a;
  const Eigen::Vector3d to = rectification.R_rectified_left * *b;
  if (!(from.z() > 0) || !(to.z() > 0)) return std::nullopt;
  const Eigen::Vector2d d = to.head<2>() / to.z() - from.head<2>() / from.z();
  return std::atan2(std::abs(d.y()), std::abs(d.x()));
}

}  // namespace vernier::stereo
