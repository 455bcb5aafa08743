// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/place/view_camera.h"

#include <algorithm>
#include <cmath>

#include "calib/camera.h"
#include "calib/error.h"
#include "calib/pose.h"
#include "localise/place.h"

namespace vernier::localise::internal {

ViewCamera view_camera(const PlaceView& view) {
  if (!view.rig || view.rig->cameras.size() < 2) {
    throw Error("place view", "has no rig of two cameras", "set PlaceView::rig");
  }
  constexpr double margin_px = 10;  // lines shorter than this at the border are not detected
  constexpr double widest_tan = 3;  // of half the field of view
  const Camera& camera = view.rig->cameras[0];
  const double f = camera.f_px();
  const double width = camera.size_px.x() - 1.0, height = camera.size_px.y() - 1.0;
  // Where a pixel of the border lies without distortion; beyond the lens's limit it is widest_tan.
  const auto ideal = [&](double u_px, double v_px, int axis) {
    const auto ray = try_unproject(camera, {u_px, v_px});
    const bool positive = axis == 0 ? u_px > camera.ox_px() : v_px > camera.oy_px();
    const double limit = positive ? widest_tan : -widest_tan;
    const double tangent = ray && ray->z() > 0 ? (*ray)[axis] / ray->z() : limit;
    return static_cast<float>(f * std::clamp(tangent, -widest_tan, widest_tan));
  };
  ViewCamera v;
  v.f_px = static_cast<float>(f);
  const Pose& T = view.rig->T_camera_first[1];
  v.baseline_m = static_cast<float>(T.t.norm());
  const Eigen::Vector2d across = (T.R.transpose() * T.t).head<2>();
  if (across.norm() > 1e-9) {  // not straight ahead
    v.baseline_u = static_cast<float>(across.x() / across.norm());
    v.baseline_v = static_cast<float>(across.y() / across.norm());
  }
  v.height_m = static_cast<float>(view.mount.height_m);
  v.cos_pitch = static_cast<float>(std::cos(view.mount.pitch_rad));
  v.sin_pitch = static_cast<float>(std::sin(view.mount.pitch_rad));
  v.left_px = ideal(margin_px, camera.oy_px(), 0);
  v.right_px = ideal(width - margin_px, camera.oy_px(), 0);
  v.top_px = ideal(camera.ox_px(), margin_px, 1);
  v.bottom_px = ideal(camera.ox_px(), height - margin_px, 1);
  return v;
}

Eigen::Vector3f project(const ViewCamera& camera, const Eigen::Vector3f& point_m) {
  const float up = point_m.z() - camera.height_m;
  const float depth = camera.cos_pitch * point_m.x() - camera.sin_pitch * up;
  const float down = -camera.sin_pitch * point_m.x() - camera.cos_pitch * up;
  const float w = 1 / depth;
  return {-camera.f_px * point_m.y() * w, camera.f_px * down * w, w};
}

Eigen::Vector3f unproject(const ViewCamera& camera, const Eigen::Vector3f& uvw) {
  const float depth = 1 / uvw[2], right = uvw[0] * depth / camera.f_px;
  const float down = uvw[1] * depth / camera.f_px;
  return {camera.cos_pitch * depth - camera.sin_pitch * down, -right,
          camera.height_m - camera.sin_pitch * depth - camera.cos_pitch * down};
}

Eigen::Matrix3f step_jacobian(const ViewCamera& camera, const Eigen::Vector3f& uvw) {
  const float f = camera.f_px, u = uvw[0], v = uvw[1], w = uvw[2];
  const float depth = 1 / w, right = u * depth / f, down = v * depth / f;
  // The point in the robot frame, and its apparent motion: -1 along the step, and against the turn.
  const float x = camera.cos_pitch * depth - camera.sin_pitch * down, y = -right;
  const Eigen::RowVector3f dx(-1, 0, y), dy(0, -1, -x);
  const Eigen::RowVector3f ddepth = camera.cos_pitch * dx, ddown = -camera.sin_pitch * dx;
  Eigen::Matrix3f J;
  J.row(0) = -f * w * dy - u * w * ddepth;
  J.row(1) = f * w * ddown - v * w * ddepth;
  J.row(2) = -w * w * ddepth;
  return J;
}

}  // namespace vernier::localise::internal
