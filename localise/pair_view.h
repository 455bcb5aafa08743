// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <memory>

#include "calib/rig.h"
#include "localise/pair_corners.h"
#include "localise/place.h"
#include "stereo/grey_levels.h"

namespace vernier::localise {

struct PairViewOptions {
  int min_disparity_px = 0;
  int max_disparity_px = 0;  ///< 0: a quarter of the image's width
  int threads = 1;           ///< for rectification; 0: all
  PlaceLineOptions lines;
  bool with_corners = false;  ///< PlaceView::corners, by corners_of_pair()
  PairCornersOptions corners;
  Eigen::MatrixXd calibration;  ///< of corners: covariance of the rig's parameters; empty: unknown
};

/// The view that a pair of images of the rig gives: rectified, edges found and matched by the
/// matcher `edge` (stereo/edge_matcher.h), straight segments placed in space (docs/segments3d.md),
/// reliable lines selected. Lines without a disparity are monocular ones. Image lines are in pixels
/// of the left image as given. Throws Error for a rig without exactly two cameras that can be
/// rectified, and images of another size.
PlaceView view_of_pair(const std::shared_ptr<const Rig>& rig,
                       const stereo::GreyLevels& left,
                       const stereo::GreyLevels& right,
                       const CameraMount& mount,
                       const PairViewOptions& options = {});

}  // namespace vernier::localise
