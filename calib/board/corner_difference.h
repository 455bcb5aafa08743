// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>

#include "calib/board_observations.h"

namespace vernier::internal {

/// Difference of the corners that two views share, by id; infinite where these are fewer than four.
struct CornerDifference {
  double largest_px = std::numeric_limits<double>::infinity();  ///< of a coordinate
  double rms_px = std::numeric_limits<double>::infinity();      ///< per coordinate
};

/// Infinite as well as soon as the sum of squares tells that rms_px would be above `max_px`.
CornerDifference corner_difference(const BoardView& a, const BoardView& b, double max_px);

}  // namespace vernier::internal
