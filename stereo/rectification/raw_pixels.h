// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>

#include "calib/camera.h"
#include "calib/rig.h"
#include "stereo/rectification.h"

namespace vernier::stereo::internal {

/// Camera 0 or 1 of the pair. Throws Error for another.
const Camera& camera_of_pair(const Rig& rig, int camera);

/// The rotation of camera 0 or 1 to the rectified ones.
const Eigen::Matrix3d& turn_of(const RectifiedGeometry& geometry, int camera);

/// Raw positions of many rectified pixels: raw_pixel() prepared for one camera.
class RawPixels {
 public:
  RawPixels(const Rig& rig, const RectifiedGeometry& geometry, int camera);
  std::optional<Eigen::Vector2d> at(const Eigen::Vector2d& rectified_px) const;
  /// The same, or nullopt outside the raw image.
  std::optional<Eigen::Vector2d> in_image_at(const Eigen::Vector2d& rectified_px) const;

 private:
  Camera camera_;
  Eigen::Matrix3d R_camera_rectified_;
  double f_px_;
  Eigen::Vector2d centre_px_;
  double sure_radius_ = 0;  ///< of (x / z, y / z): within it no ray is beyond a fold
};

}  // namespace vernier::stereo::internal
