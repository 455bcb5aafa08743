// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "stereo/grey_levels.h"

namespace vernier::stereo {

/// Two images of which every row shows the same epipolar plane.
struct RectifiedPair {
  GreyLevels left, right;
};

/// Disparities u_left − u_right that are searched, both ends included.
struct DisparityRange {
  int min_px = 0, max_px = 64;
};

}  // namespace vernier::stereo
