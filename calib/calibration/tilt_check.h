// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/calibration/observation_checks.h"

namespace vernier::internal {

/// The number of distinct unit normals: one is new if it differs by at least `apart_rad` from all
/// counted before it.
int distinct_tilts(const std::vector<Eigen::Vector3d>& normals, double apart_rad = 0.07);

/// Checks that the boards' tilts determine the intrinsics (Zhang 2000: every new orientation of the
/// plane gives two equations, parallel planes none). Uses for each camera of a start the normals of
/// the boards, each from its image alone, and the standard deviation of the focal length predicted
/// by the information at the start, with the noise of the single images.
///
/// Throws Error naming the camera for boards all parallel to the image, for fewer than three
/// distinct tilts (4 degrees apart), and if the focal length would be known to 20 % at best. A
/// trust warning if it would be known to 5 % at best.
ObservationDiagnosis check_tilts(const BoardObservations& observations, const BoardState& start);

}  // namespace vernier::internal
