// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/rectified_camera_info.h"

#include "calib/opencv_intrinsics.h"
#include "stereo/rectification.h"

namespace vernier {
namespace {

/// Where the middle of the image goes on the rectified camera's plane z = 1; its own optical axis
/// where the model cannot be inverted in the middle.
Eigen::Vector2d rectified_middle(const Camera& camera, const Eigen::Matrix3d& R_rectified_camera) {
  const Eigen::Vector2d middle = 0.5 * (camera.size_px - Eigen::Vector2i::Ones()).cast<double>();
  const Eigen::Vector3d ray =
      R_rectified_camera * try_unproject(camera, middle).value_or(Eigen::Vector3d::UnitZ());
  return ray.head<2>() / ray.z();
}

}  // namespace

std::vector<RosCameraInfo> rectified_camera_info(const Rig& rig) {
  std::vector<RosCameraInfo> infos;
  for (const Camera& camera : rig.cameras) {
    RosCameraInfo info;
    info.camera = camera;
    info.P.leftCols<3>() = camera_matrix(opencv_intrinsics(camera));
    infos.push_back(info);
  }
  if (rig.cameras.size() != 2) return infos;

  const Rectification turn = rectification(rig);
  infos[0].R_rectified_camera = turn.R_rectified_left;
  infos[1].R_rectified_camera = turn.R_rectified_right;
  const double f = 0.5 * (rig.cameras[0].f_px() + rig.cameras[1].f_px());
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  for (const RosCameraInfo& info : infos) {
    centre += 0.25 * (info.camera.size_px - Eigen::Vector2i::Ones()).cast<double>() -
              0.5 * f * rectified_middle(info.camera, info.R_rectified_camera);
  }
  for (RosCameraInfo& info : infos) {
    info.P << f, 0, centre[0], 0, 0, f, centre[1], 0, 0, 0, 1, 0;
  }
  infos[1].P(0, 3) = -f * rig.T_camera_first[1].t.norm();
  return infos;
}

}  // namespace vernier
