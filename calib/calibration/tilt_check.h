// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/calibration/observation_checks.h"

namespace vernier::internal {

/// The unit normals counted as distinct: one is new where it stands at least `apart_rad` from all
/// counted before it.
int distinct_tilts(const std::vector<Eigen::Vector3d>& normals, double apart_rad = 0.07);

/// Do the boards' tilts determine the intrinsics (Zhang 2000: every new orientation of the plane
/// gives two equations, parallel planes none)? Looks at each camera of a start: the normals of the
/// boards, each by its image alone, and the standard deviation of the focal length that the
/// information at the start promises, with the noise that the images leave alone.
///
/// Throws Error naming the camera for boards all parallel to the image, for fewer than three
/// distinct tilts (4 degrees apart), and where the focal length would be known to 20 % at best. A
/// doubt where it would be known to 5 % at best.
ObservationDiagnosis check_tilts(const BoardObservations& observations, const BoardState& start);

}  // namespace vernier::internal
