// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "stereo/rectification/vertical_field.h"

namespace vernier::stereo::internal {

/// A match: the right image has it `dy_px` lower than the left one.
struct VerticalOffset {
  Eigen::Vector2d at_px;  ///< the right column and the left row
  double dy_px = 0;
  double sigma_px = 0;  ///< of dy, as its alignment says
};

/// Step 3 of vertical_field(), from the matches of `corners` corners of images of a size.
VerticalField fit_vertical_field(const std::vector<VerticalOffset>& offsets,
                                 int corners,
                                 const Eigen::Vector2i& size_px,
                                 const VerticalFieldOptions& options = {});

}  // namespace vernier::stereo::internal
