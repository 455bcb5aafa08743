// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "stereo/grey_levels.h"
#include "tests/support/edge_images.h"

namespace vernier::test {

using namespace vernier::stereo;

/// A straight edge that both images of a rectified pair show, with a disparity linear in the row:
/// d(y) = disparity_px + by_y (y − centre's y). No noise, not rounded.
struct StepPair {
  Step left;
  double disparity_px = 12.3, by_y = 0;

  double disparity_at(double y) const { return disparity_px + by_y * (y - left.centre.y()); }

  RectifiedPair images(int width, int height) const {
    const auto level = [&](const Eigen::Vector2d& p) { return left.level(p); };
    const auto moved = [&](const Eigen::Vector2d& p) {
      return left.level(p + Eigen::Vector2d(disparity_at(p.y()), 0));
    };
    return {sampled(width, height, level), sampled(width, height, moved)};
  }
};

}  // namespace vernier::test
