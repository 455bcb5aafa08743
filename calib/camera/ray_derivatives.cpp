// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/camera/ray_derivatives.h"

#include <Eigen/LU>

#include "calib/camera.h"

namespace vernier::internal {

RayDerivatives derivatives_of_ray(const Camera& camera, const Eigen::Vector3d& ray) {
  ProjectionJacobian J;
  project(camera, ray, J);
  RayDerivatives d;
  d.by_pixel.topRows<2>() = J.point.leftCols<2>().inverse();
  d.by_camera = -d.by_pixel * J.camera;
  return d;
}

}  // namespace vernier::internal
