// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "calib/pose.h"
#include "calib/rig.h"
#include "sim/images/image_scene.h"
#include "stereo/rectification.h"
#include "stereo/stereo_truth.h"

namespace vernier::sim::internal {

/// Ground truth of a pair that the true rig took and that was rectified by the rig that is told:
/// where the two images of what a left pixel sees are in fact, in the told geometry. They need not
/// be in one row. Per pixel of the left image, row-major.
struct ToldTruth {
  /// u_left − u_right. Occluded: by the rules of stereo_truth for the left map alone, if the right
  /// camera does not have the point in its image or the rectified one, or if a surface of a
  /// disparity more than 1 px larger hides it.
  stereo::StereoTruth stereo;
  std::vector<float> vertical_px;  ///< v_right − v_left; NaN where unknown
  /// Along the axis of the told rectified left camera, in metres: what the disparity above should
  /// be turned into. NaN where unknown.
  std::vector<float> depth_m;
};

/// `geometry` is that of the told rig, the left camera of the true one at T_left_world. With the
/// true rig told, disparities and depths are those of pair_truth. Throws Error if nothing is known,
/// as where no camera sees what the other does.
ToldTruth told_truth(const ImageScene& scene,
                     const Rig& truth,
                     const Rig& told,
                     const stereo::RectifiedGeometry& geometry,
                     const Pose& T_left_world,
                     int threads);

}  // namespace vernier::sim::internal
