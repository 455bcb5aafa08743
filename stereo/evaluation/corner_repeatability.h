// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "stereo/corners/corner_match.h"
#include "stereo/stereo_truth.h"

namespace vernier::stereo::internal {

struct CornerRepeatOptions {
  double within_px = 1.5;  ///< maximum distance of a right corner from the true position
  double border_px = 12;   ///< true positions closer to the right image border are skipped
};

/// Whether a left corner is detected again in the right image.
struct CornerRepeatability {
  Eigen::Vector2d left_px;
  bool found = false;
  /// Chance level: fraction of eight displacements by 12 px with another corner as near.
  double chance = 0;
};

/// Repeatability of the left corners with known ground truth that are visible in the right image.
/// At a truth discontinuity any disparity of the 3 x 3 pixels counts.
std::vector<CornerRepeatability> corner_repeatabilities(
    const std::vector<Eigen::Vector2d>& left_px,
    const std::vector<Eigen::Vector2d>& right_px,
    const StereoTruth& truth,
    const CornerRepeatOptions& options = {});

/// Distance of a match from the true position of its left corner.
struct CornerError {
  Eigen::Vector2d left_px;
  double error_px = 0;
};

/// For matches whose left corner has known ground truth, occluded ones included.
std::vector<CornerError> corner_errors(const std::vector<CornerMatch>& matches,
                                       const StereoTruth& truth);

}  // namespace vernier::stereo::internal
