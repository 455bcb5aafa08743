// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "calib/camera.h"
#include "calib/pose.h"
#include "stereo/image/depth_image.h"

namespace vernier::sim::internal {

struct DepthCloudOptions {
  int step_px = 4;         ///< between pixels that are taken, in both directions
  double max_depth_m = 5;  ///< farther ones err too much
  /// Pixels whose neighbours half a step away differ by more than this share of their depth stand
  /// between two surfaces, or on neither.
  double step_share = 0.03;
};

/// Points of surfaces from depth maps, world frame, each with the view that saw it.
class DepthCloud {
 public:
  struct Point {
    Eigen::Vector3f at_m;
    int view = 0;
  };

  explicit DepthCloud(const DepthCloudOptions& options = {}) : options_(options) {}

  /// Throws Error unless the camera is a pinhole of the map's size.
  void add(const stereo::internal::DepthImage& depth,
           const Camera& camera,
           const Pose& T_world_camera);

  const std::vector<Point>& points() const { return points_; }
  /// Where the camera of each view was.
  const std::vector<Eigen::Vector3d>& eyes_m() const { return eyes_m_; }

 private:
  DepthCloudOptions options_;
  std::vector<Point> points_;
  std::vector<Eigen::Vector3d> eyes_m_;
};

}  // namespace vernier::sim::internal
