// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/camera.h"
#include "calib/pose.h"

namespace vernier::internal {

/// A start from the corners alone: each camera separately (calib/solver/initial_camera.h), then the
/// cameras chained by their common frames. The pose between two cameras is the median over the
/// frames that agree with the candidate of best consensus, so views that are rotated, swapped or
/// not simultaneous do not matter while they are the minority; check_views
/// (calib/calibration/view_checks.h) finds them. Throws Error if a camera has fewer than three
/// views or shares no frame with those before it.
BoardState initial_state(const BoardObservations& observations,
                         const std::vector<CameraModel>& models);

/// The pose that most of `candidates` agree on: the median of the candidates within three times the
/// least median distance from the candidate that has it. Does not throw; the identity if there are
/// no candidates.
Pose consensus_pose(const std::vector<Pose>& candidates);

}  // namespace vernier::internal
