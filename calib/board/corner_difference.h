// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>

#include "calib/board_observations.h"

namespace vernier::internal {

/// Difference between the corners common to two views, by id; infinite for fewer than four.
struct CornerDifference {
  double largest_px = std::numeric_limits<double>::infinity();  ///< of a coordinate
  double rms_px = std::numeric_limits<double>::infinity();      ///< per coordinate
};

/// Also infinite as soon as the sum of squares shows that rms_px would exceed `max_px`.
CornerDifference corner_difference(const BoardView& a, const BoardView& b, double max_px);

}  // namespace vernier::internal
