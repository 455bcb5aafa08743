// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/built/depth_cloud.h"

#include <fmt/format.h>

#include <cmath>
#include <variant>

#include "calib/camera.h"
#include "calib/error.h"
#include "calib/lens_models.h"
#include "calib/pose.h"
#include "stereo/image/depth_image.h"

namespace vernier::sim::internal {

using stereo::internal::DepthImage;

void DepthCloud::add(const DepthImage& depth, const Camera& camera, const Pose& T_world_camera) {
  if (!std::holds_alternative<Pinhole>(camera.model)) {
    throw Error("camera \"" + camera.name + "\"", "has a lens with distortion",
                "give undistorted depths, and their pinhole camera");
  }
  if (camera.size_px != Eigen::Vector2i(depth.width_px, depth.height_px)) {
    throw Error("camera \"" + camera.name + "\"",
                fmt::format("is of {}x{} px, the depth map of {}x{}", camera.size_px[0],
                            camera.size_px[1], depth.width_px, depth.height_px),
                "give the depth map's camera");
  }
  const int view = static_cast<int>(eyes_m_.size());
  eyes_m_.push_back(T_world_camera.t);
  const int beside = std::max(1, options_.step_px / 2);
  const auto is_smooth = [&](int x, int y) {
    const float z = depth(x, y);
    for (const auto& [dx, dy] : {std::pair(beside, 0), {-beside, 0}, {0, beside}, {0, -beside}}) {
      if (!(std::abs(depth(x + dx, y + dy) - z) <= options_.step_share * z)) return false;
    }
    return true;
  };
  for (int y = beside; y < depth.height_px - beside; y += options_.step_px) {
    for (int x = beside; x < depth.width_px - beside; x += options_.step_px) {
      const double z = depth(x, y);
      if (!(z > 0 && z <= options_.max_depth_m) || !is_smooth(x, y)) continue;
      const Eigen::Vector3d ray((x - camera.ox_px()) / (camera.f_px() * camera.ax()),
                                (y - camera.oy_px()) / camera.f_px(), 1);
      points_.push_back({(T_world_camera * (z * ray)).cast<float>(), view});
    }
  }
}

}  // namespace vernier::sim::internal
