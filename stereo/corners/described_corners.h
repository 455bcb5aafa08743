// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "calib/rig.h"
#include "stereo/corners/corner_match.h"
#include "stereo/grey_levels.h"

namespace vernier::stereo::internal {

/// A matched corner and what the left image looks like around it
/// (stereo/corners/patch_descriptor.h), in the scale at which it was matched: descriptors of two
/// rigs compare if their left images are reduced alike (stereo/corners/corner_image.h).
struct DescribedCorner {
  CornerMatch match;
  Eigen::VectorXf descriptor;
};

struct DescribedCornerOptions {
  int corners = 1200;      ///< maximum in the left image; the right one may have half as many more
  int cells = 12;          ///< they are distributed evenly over a grid of cells x cells; 0: not
  double nearest_m = 0.5;  ///< nearer corners are not matched
};

/// Corners matched within the epipolar bands of a rig with this covariance (docs/matching.md), but
/// those without texture. Throws Error for a rig without two cameras, and images of another size.
std::vector<DescribedCorner> described_corners(const Rig& rig,
                                               const Eigen::MatrixXd& covariance,
                                               const GreyLevels& left,
                                               const GreyLevels& right,
                                               const DescribedCornerOptions& options = {});

}  // namespace vernier::stereo::internal
