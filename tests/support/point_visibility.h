// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstddef>
#include <vector>

#include "calib/camera.h"
#include "calib/pose.h"
#include "sim/visibility.h"
#include "sim/world.h"

namespace vernier::test {

using namespace vernier::sim;
using Eigen::Vector2d;
using Eigen::Vector3d;

/// Whether a ray from the eye through x meets the polygon's interior before x, by counting how
/// often a half-line in the plane crosses the border. Shares nothing with the code under test.
inline bool blocks(const std::vector<Vector3d>& polygon,
                   const Vector3d& eye,
                   const Vector3d& x,
                   double gap_m) {
  Vector3d n = Vector3d::Zero();
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    n += polygon[i].cross(polygon[(i + 1) % polygon.size()]);
  }
  if (n.norm() < 1e-9) return false;
  n.normalize();
  const double h_eye = n.dot(eye - polygon[0]), h_x = n.dot(x - polygon[0]);
  if (h_eye * h_x >= 0 || std::abs(h_x) <= gap_m) return false;
  const Vector3d hit = eye + h_eye / (h_eye - h_x) * (x - eye);
  int drop = 0;
  n.cwiseAbs().maxCoeff(&drop);
  const int i = (drop + 1) % 3, j = (drop + 2) % 3;
  bool inside = false;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Vector3d &p = polygon[k], &q = polygon[(k + 1) % polygon.size()];
    if ((p[j] > hit[j]) == (q[j] > hit[j])) continue;
    if (hit[i] < p[i] + (hit[j] - p[j]) / (q[j] - p[j]) * (q[i] - p[i])) inside = !inside;
  }
  return inside;
}

/// The slow way to ask what a camera sees of one point.
struct Oracle {
  const World& world;
  const Camera& camera;
  Pose T_camera_world;
  VisibilityOptions options;

  bool sees(const Vector3d& point) const {
    const Vector3d x = T_camera_world * point;
    if (x.z() < options.near_m || x.z() > options.far_m) return false;
    const Vector2d pixel = project(camera, x);
    if (!in_image(camera, pixel)) return false;
    // Beyond the fold of the distortion a point lands on a pixel that shows another.
    if ((unproject(camera, pixel) - x / x.z()).norm() > 1e-6) return false;
    const Vector3d eye = T_camera_world.inverse().t;
    for (const WorldSurface& surface : world.surfaces) {
      if (blocks(surface.polygon_m, eye, point, options.surface_gap_m)) return false;
    }
    return true;
  }
};

}  // namespace vernier::test
