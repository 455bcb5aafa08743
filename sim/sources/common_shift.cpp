// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/sources/common_shift.h"

#include <Eigen/Geometry>
#include <cmath>

#include "calib/base/plane_vectors.h"
#include "calib/camera.h"
#include "calib/pose.h"
#include "calib/rig.h"

namespace vernier::sim::internal {

using vernier::internal::cross;

namespace {

/// Pixels across the image of an edge by a displacement of one metre of it, in the camera's frame.
double across_by(const Camera& camera,
                 const Eigen::Vector3d& middle_m,
                 const Eigen::Vector3d& along,
                 const Eigen::Vector3d& displaced) {
  ProjectionJacobian J;
  project(camera, middle_m, J);
  const Eigen::Vector2d d = (J.point * along).normalized();
  return cross(d, J.point * displaced);
}

}  // namespace

double right_by_left_shift(const Rig& rig, const Eigen::Vector3d& a_m, const Eigen::Vector3d& b_m) {
  const Pose& T = rig.T_camera_first[1];
  const Eigen::Vector3d middle_m = 0.5 * (a_m + b_m), along = b_m - a_m;
  const Eigen::Vector3d plane = a_m.cross(b_m);  // its trace in the image plane is the line
  const Eigen::Vector3d displaced(plane.x(), plane.y(), 0);
  const double ratio = across_by(rig.cameras[1], T * middle_m, T.R * along, T.R * displaced) /
                       across_by(rig.cameras[0], middle_m, along, displaced);
  return std::isfinite(ratio) ? ratio : 1;
}

}  // namespace vernier::sim::internal
