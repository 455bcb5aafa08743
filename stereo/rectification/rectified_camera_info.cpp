// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/rectification/rectified_camera_info.h"

#include "calib/camera.h"
#include "calib/camera/opencv_intrinsics.h"
#include "calib/formats/ros_camera_info.h"
#include "calib/rig.h"
#include "stereo/rectification.h"

namespace vernier::stereo::internal {

using namespace vernier::internal;

std::vector<RosCameraInfo> rectified_camera_info(const Rig& rig) {
  std::vector<RosCameraInfo> infos;
  for (const Camera& camera : rig.cameras) {
    RosCameraInfo info;
    info.camera = camera;
    info.P.leftCols<3>() = camera_matrix(opencv_intrinsics(camera));
    infos.push_back(info);
  }
  if (rig.cameras.size() != 2) return infos;

  const double f = 0.5 * (rig.cameras[0].f_px() + rig.cameras[1].f_px());
  const RectifiedGeometry geometry = rectified_geometry(rig, {.f_px = f});
  infos[0].R_rectified_camera = geometry.turn.R_rectified_left;
  infos[1].R_rectified_camera = geometry.turn.R_rectified_right;
  const Eigen::Vector2d& centre = geometry.centre_px;
  for (RosCameraInfo& info : infos) {
    info.P << f, 0, centre[0], 0, 0, f, centre[1], 0, 0, 0, 1, 0;
  }
  infos[1].P(0, 3) = -f * rig.T_camera_first[1].t.norm();
  return infos;
}

}  // namespace vernier::stereo::internal
