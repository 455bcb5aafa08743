// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "localise/joined_lines.h"
#include "localise/place.h"

namespace vernier::localise::internal {

/// The lines of a place's view as segments in its robot's frame (T_world_camera is that of the
/// robot, at `pose`). A view states one standard deviation for a line's distance, so a covariance
/// has to be made up: that along the ray of each end, the same error for both ends of a vertical
/// line, since it was placed at their mean; and across the rays 1 mm and 2 mrad, about a pixel.
SegmentsOfView segments_of_place(const PlaceView& view, const Pose2D& pose);

}  // namespace vernier::localise::internal
