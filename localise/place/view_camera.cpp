// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/place/view_camera.h"

#include <algorithm>
#include <cmath>

#include "calib/camera.h"
#include "calib/error.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "localise/place.h"

namespace vernier::localise::internal {
namespace {

constexpr double margin_px = 10;  // lines shorter than this at the border are not detected
constexpr double widest_tan = 3;  // of half the field of view

/// The box through the middles of an image's borders without distortion, less a margin, as seen by
/// a camera turned against it. Beyond the lens's limit it ends at widest_tan.
Eigen::AlignedBox2f image_box(const Camera& camera,
                              const Eigen::Matrix3d& R_seen_camera,
                              double f_px) {
  const Eigen::Vector2d principal(camera.ox_px(), camera.oy_px());
  const Eigen::Vector2d last = camera.size_px.cast<double>().array() - 1 - margin_px;
  Eigen::AlignedBox2f box;
  for (const Eigen::Vector2d& px :
       {Eigen::Vector2d(margin_px, principal.y()), Eigen::Vector2d(last.x(), principal.y()),
        Eigen::Vector2d(principal.x(), margin_px), Eigen::Vector2d(principal.x(), last.y())}) {
    const auto ray = try_unproject(camera, px);
    const Eigen::Vector2d beyond = widest_tan * (px - principal).normalized();
    const Eigen::Vector3d direction =
        R_seen_camera * (ray ? *ray : Eigen::Vector3d(beyond.x(), beyond.y(), 1));
    const Eigen::Array2d tangent =
        direction.head<2>().array() / std::max(direction.z(), 1e-3 * direction.norm());
    box.extend((f_px * tangent.max(-widest_tan).min(widest_tan)).matrix().cast<float>());
  }
  return box;
}

ViewCamera::Borders cuts_of(const ViewCamera& v) {
  constexpr float few_px = 5;
  const Eigen::Vector2f most = v.f_px / nearest_compared_m * v.eye_m;  // largest displacement
  const Eigen::Vector2f low = most.cwiseMin(0), high = most.cwiseMax(0);
  const Eigen::Vector2f least_px = v.of_right_px.min(), last_px = v.of_right_px.max();
  ViewCamera::Borders cuts;
  cuts.left = v.left_px - high.x() < least_px.x() - few_px;
  // where the right eye's border is cut, it comes first
  cuts.own_left = !(cuts.left && v.eye_m.x() > 0 && least_px.x() > v.left_px - few_px);
  cuts.right = v.right_px - low.x() > last_px.x() + few_px;
  cuts.top = v.top_px - high.y() < least_px.y() - few_px;
  cuts.bottom = v.bottom_px - low.y() > last_px.y() + few_px;
  return cuts;
}

}  // namespace

ViewCamera view_camera(const PlaceView& view) {
  if (!view.rig || view.rig->cameras.size() < 2) {
    throw Error("place view", "has no rig of two cameras", "set PlaceView::rig");
  }
  const Camera& camera = view.rig->cameras[0];
  const double f = camera.f_px();
  ViewCamera v;
  v.f_px = static_cast<float>(f);
  const Pose& T = view.rig->T_camera_first[1];
  v.baseline_m = static_cast<float>(T.t.norm());
  v.eye_m = (-T.R.transpose() * T.t).head<2>().cast<float>();
  if (v.eye_m.norm() > 1e-9F) v.along_baseline = v.eye_m.normalized();  // not straight ahead
  v.height_m = static_cast<float>(view.mount.height_m);
  v.cos_pitch = static_cast<float>(std::cos(view.mount.pitch_rad));
  v.sin_pitch = static_cast<float>(std::sin(view.mount.pitch_rad));
  const Eigen::AlignedBox2f own = image_box(camera, Eigen::Matrix3d::Identity(), f);
  v.left_px = own.min().x();
  v.right_px = own.max().x();
  v.top_px = own.min().y();
  v.bottom_px = own.max().y();
  v.of_right_px = image_box(view.rig->cameras[1], T.R.transpose(), f);
  v.cuts = cuts_of(v);
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
