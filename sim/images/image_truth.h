// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "calib/pose.h"
#include "calib/rig.h"
#include "sim/images/image_scene.h"
#include "stereo/disparity_file.h"
#include "stereo/grey_levels.h"
#include "stereo/rectification.h"

namespace vernier::sim::internal {

/// The two pinhole cameras that a rig's images are rectified to, in the world.
struct RectifiedView {
  stereo::RectifiedGeometry geometry;
  Rig rig;
  Pose T_left_world, T_right_world;  ///< of the rectified cameras
};

/// For the rig's left camera at T_left_world, geometry from rectified_geometry.
RectifiedView rectified_view(const Rig& rig,
                             const stereo::RectifiedGeometry& geometry,
                             const Pose& T_left_world);

/// Ground truth of a rectified pair at the pixel centres, from depths along the rays:
///
///     d = f B / z
///
/// Unknown where nothing is hit or the raw image has no source. `right` holds the disparities of
/// the right image, u_left - u_right too.
struct PairTruth {
  stereo::DisparityMap left, right;
  std::vector<double> left_depth_m;  ///< rectified, NaN where unknown
};
PairTruth pair_truth(const ImageScene& scene,
                     const Rig& rig,
                     const RectifiedView& view,
                     int threads);

/// Disparities to search: from 0, or 2 px below the smallest true one if that is negative, to 2 px
/// above the largest; at most half the width either way.
stereo::DisparityRange search_range(const stereo::DisparityMap& truth);

}  // namespace vernier::sim::internal
