// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "stereo/rectification/vertical_field.h"

namespace vernier::stereo::internal {

/// A match with a vertical offset: `dy_px` lower in the right image than in the left one.
struct VerticalOffset {
  Eigen::Vector2d at_px;  ///< column in the right and row in the left image
  double dy_px = 0;
  double sigma_px = 0;  ///< of dy, as estimated by the alignment
};

/// Step 3 of vertical_field(), from the matches of `corners` corners, for a given image size.
VerticalField fit_vertical_field(const std::vector<VerticalOffset>& offsets,
                                 int corners,
                                 const Eigen::Vector2i& size_px,
                                 const VerticalFieldOptions& options = {});

}  // namespace vernier::stereo::internal
