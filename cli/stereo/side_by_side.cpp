// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/stereo/side_by_side.h"

#include <Eigen/Geometry>

#include "calib/error.h"
#include "calib/pose.h"
#include "calib/rig.h"

namespace vernier::cli {

void require_side_by_side(const Rig& rig, const std::string& place) {
  constexpr double least_sine = 0.34;  // 20 degrees: rectified cameras would look 70 off their axes
  const Pose& T = rig.T_camera_first[1];
  const Eigen::Vector3d baseline = T.R.transpose() * T.t;
  const Eigen::Vector3d axis = Eigen::Vector3d::UnitZ() + T.R.row(2).transpose();
  if (axis.cross(baseline).norm() >= least_sine * axis.norm() * baseline.norm()) return;
  throw Error(place,
              "one camera is behind the other: the baseline is within 20 degrees of the optical "
              "axes, and no plane holds both images",
              "use cameras beside or above each other, or check the translation");
}

}  // namespace vernier::cli
