// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "stereo/corners/corner_match.h"
#include "stereo/stereo_truth.h"

namespace vernier::stereo::internal {

struct CornerRepeatOptions {
  double within_px = 1.5;  ///< a right corner this near to where the truth puts it is the same one
  double border_px = 12;   ///< what falls nearer to the right image's border is not asked for
};

/// Whether the right image has a corner for a left one that it should show.
struct CornerRepeatability {
  Eigen::Vector2d left_px;
  bool found = false;
  double chance = 0;  ///< share of eight displacements by 12 px where some other corner is as near
};

/// Left corners that the truth knows and the right image shows, against the right image's corners.
/// At a step of the truth any disparity of the 3 x 3 pixels counts.
std::vector<CornerRepeatability> corner_repeatabilities(
    const std::vector<Eigen::Vector2d>& left_px,
    const std::vector<Eigen::Vector2d>& right_px,
    const StereoTruth& truth,
    const CornerRepeatOptions& options = {});

/// How far a match is from where the truth puts the left corner.
struct CornerError {
  Eigen::Vector2d left_px;
  double error_px = 0;
};

/// Of matches whose left corner the truth knows, those on occluded corners included.
std::vector<CornerError> corner_errors(const std::vector<CornerMatch>& matches,
                                       const StereoTruth& truth);

}  // namespace vernier::stereo::internal
