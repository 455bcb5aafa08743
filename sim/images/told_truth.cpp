// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/images/told_truth.h"

#include <Eigen/Geometry>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "calib/camera.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "sim/images/depths.h"
#include "sim/images/image_scene.h"
#include "stereo/disparity_file.h"
#include "stereo/rectification.h"
#include "stereo/rectification/raw_pixels.h"
#include "stereo/stereo_truth.h"

namespace vernier::sim::internal {

namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double none = std::numeric_limits<double>::quiet_NaN();

/// Rays (x / z, y / z) of the true left camera through the pixels of the told rectified one.
std::vector<Vector2d> left_rays(const Rig& truth,
                                const Rig& told,
                                const stereo::RectifiedGeometry& geometry) {
  const stereo::internal::RawPixels raw(told, geometry, 0);
  std::vector<Vector2d> rays;
  rays.reserve(static_cast<std::size_t>(geometry.size_px.prod()));
  for (int y = 0; y < geometry.size_px[1]; ++y) {
    for (int x = 0; x < geometry.size_px[0]; ++x) {
      const auto raw_px = raw.in_image_at({x, y});
      const auto ray = raw_px ? try_unproject(truth.cameras[0], *raw_px) : std::nullopt;
      rays.push_back(ray ? Vector2d(ray->head<2>()) : Vector2d(none, none));
    }
  }
  return rays;
}

/// Where the right camera has a point, rectified.
struct RightPixel {
  Vector2d px;
  bool in_images;  ///< in the raw image and in a row of the rectified one
};

/// Of a point of the right camera's frame; nullopt if the rigs cannot image it.
std::optional<RightPixel> right_pixel(const Rig& truth,
                                      const Rig& told,
                                      const stereo::RectifiedGeometry& geometry,
                                      const Vector3d& x_right) {
  const Camera& camera = truth.cameras[1];
  const auto raw_px = try_project(camera, x_right);
  const auto px = raw_px ? stereo::rectified_pixel(told, geometry, 1, *raw_px) : std::nullopt;
  if (!px) return std::nullopt;
  const bool in_row = px->y() >= 0 && px->y() <= geometry.size_px[1] - 1;
  return RightPixel{*px, in_image(camera, *raw_px) && in_row};
}

}  // namespace

ToldTruth told_truth(const ImageScene& scene,
                     const Rig& truth,
                     const Rig& told,
                     const stereo::RectifiedGeometry& geometry,
                     const Pose& T_left_world,
                     int threads) {
  const std::vector<Vector2d> rays = left_rays(truth, told, geometry);
  const std::vector<double> left_z = depths_along(scene, T_left_world, rays, threads);
  const Pose& T_right_left = truth.T_camera_first[1];

  ToldTruth result;
  result.vertical_px.assign(rays.size(), static_cast<float>(none));
  result.depth_m.assign(rays.size(), static_cast<float>(none));
  stereo::DisparityMap map{geometry.size_px[0], geometry.size_px[1], {}};
  map.values.assign(rays.size(), static_cast<float>(none));
  std::vector<Vector2d> right_rays(rays.size(), Vector2d(none, none));
  std::vector<double> right_z(rays.size(), none);
  const auto width = static_cast<std::size_t>(map.width_px);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (!std::isfinite(left_z[i])) continue;
    const Vector3d x_left = left_z[i] * rays[i].homogeneous();
    const double depth_m = (geometry.turn.R_rectified_left * x_left).z();
    result.depth_m[i] = static_cast<float>(depth_m);
    const Vector3d x_right = T_right_left * x_left;
    const auto seen = right_pixel(truth, told, geometry, x_right);
    if (!seen) {  // the geometry's own disparity
      map.values[i] = static_cast<float>(geometry.disparity_px(depth_m));
      continue;
    }
    map.values[i] = static_cast<float>(static_cast<double>(i % width) - seen->px.x());
    result.vertical_px[i] = static_cast<float>(seen->px.y() - static_cast<double>(i / width));
    if (!seen->in_images) continue;
    right_rays[i] = x_right.head<2>() / x_right.z();
    right_z[i] = x_right.z();
  }
  result.stereo = stereo::stereo_truth(std::move(map));

  // A point of a right ray has a disparity in proportion to 1 / depth, up to the error of the told
  // rig.
  const std::vector<double> first_z =
      depths_along(scene, T_right_left * T_left_world, right_rays, threads);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (!std::isfinite(left_z[i])) continue;
    const double true_px = geometry.disparity_px(static_cast<double>(result.depth_m[i]));
    const bool hidden = true_px * (right_z[i] / first_z[i] - 1) > 1;
    if (!std::isfinite(right_z[i]) || hidden) result.stereo.occluded[i] = 1;
  }
  return result;
}

}  // namespace vernier::sim::internal
