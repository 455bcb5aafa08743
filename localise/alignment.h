// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "localise/place.h"

namespace vernier::localise::internal {

struct AlignmentOptions {
  double max_turn_rad = 0.61;     ///< 35 degrees either way
  double turn_step_rad = 0.0436;  ///< 2.5 degrees
  double max_shift_m = 1.5;       ///< along each axis
  double shift_step_m = 0.1;
  double position_sigma_m = 0.12;  ///< of a line's place beside its own error
};

/// A rigid motion on the floor and how much of both views it explains.
struct Alignment {
  Pose2D query_in_node;  ///< pose of the query in the node's robot frame
  double score = 0;      ///< share of both views' lines that find a partner, in [0, 1)
};

/// Best placement of one view over another from the plan of their lines: a Hough vote of upright
/// lines over turn and shift, then ascent of a robust score in which every upright or level line of
/// the query finds the line of the node that agrees with it best. The score counts both ways: a
/// line of the node explains many fragments of the query but once. Generalised Hough
/// transform after matching: Ashbrook et al. 1995. Throws Error for steps or a sigma that are not
/// above 0, a largest turn or shift below 0, and more than 1000 steps either way.
Alignment align(const PlaceView& query,
                const PlaceView& node,
                const AlignmentOptions& options = {});

}  // namespace vernier::localise::internal
