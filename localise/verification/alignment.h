// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "localise/place.h"

namespace vernier::localise::internal {

struct AlignmentOptions {
  double max_turn_rad = 0.61;     ///< 35 degrees to either side
  double turn_step_rad = 0.0436;  ///< 2.5 degrees
  double max_shift_m = 1.5;       ///< along each axis
  double shift_step_m = 0.1;
  double position_sigma_m = 0.12;  ///< of a line's position, in addition to its own error
};

/// A rigid motion on the floor and its score.
struct Alignment {
  Pose2D query_in_node;  ///< pose of the query in the node's robot frame
  double score = 0;      ///< fraction of the lines of both views that have a partner, in [0, 1)
};

/// Best alignment of two views from the floor plan of their lines: a Hough vote of vertical lines
/// over rotation and translation (generalised Hough transform, Ashbrook et al. 1995), then ascent
/// of a robust score in which every vertical or level line of the query is paired with the line of
/// the node that agrees best. The score counts both directions: one node line may match several
/// fragments in the query but counts once. Throws Error for steps or a sigma that are not above 0,
/// a negative maximum rotation or translation, and more than 1000 steps to either side.
Alignment align(const PlaceView& query,
                const PlaceView& node,
                const AlignmentOptions& options = {});

}  // namespace vernier::localise::internal
