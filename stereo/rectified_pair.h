// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "stereo/grey_levels.h"

namespace vernier::stereo {

/// Two images in which corresponding rows show the same epipolar plane.
struct RectifiedPair {
  GreyLevels left, right;
};

/// Search range of disparities u_left − u_right, both ends included.
struct DisparityRange {
  int min_px = 0, max_px = 64;
};

}  // namespace vernier::stereo
