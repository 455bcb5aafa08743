// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "calib/rig.h"
#include "localise/place.h"
#include "stereo/grey_levels.h"

namespace vernier::localise {

struct PairCornersOptions {
  int corners = 1200;      ///< maximum in the left image
  int cells = 12;          ///< they are distributed evenly over a grid of cells x cells; 0: not
  double nearest_m = 0.5;  ///< nearer corners are not matched
  /// Standard deviations beyond the image noise: of a corner's position from one moment to the
  /// next, in both images alike, and of the right pixel relative to the left one.
  double view_sigma_px = 0.25, pair_sigma_px = 0.2;
};

/// The corners of a pair of images: Harris corners, matched within the epipolar bands of the rig
/// (docs/matching.md), each with the appearance of the left image around it. `covariance` is that
/// of the rig's parameters, which widens the bands; empty if it is not known. Throws Error for a
/// rig without exactly two cameras, and images of another size.
std::vector<StereoCorner> corners_of_pair(const Rig& rig,
                                          const Eigen::MatrixXd& covariance,
                                          const stereo::GreyLevels& left,
                                          const stereo::GreyLevels& right,
                                          const PairCornersOptions& options = {});

}  // namespace vernier::localise
