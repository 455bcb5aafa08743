// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/camera.h"
#include "calib/pose.h"

namespace vernier::internal {

/// A start from the corners alone: every camera by itself (calib/solver/initial_camera.h), then the
/// cameras chained by their common frames. The pose between two cameras is the median of those
/// frames that agree with the candidate that the others agree with best, so views that are turned,
/// swapped or not simultaneous do no harm while they are the smaller part; see check_views
/// (calib/calibration/view_checks.h) for finding them. Throws Error where a camera has fewer than
/// three views or shares no frame with those before it.
BoardState initial_state(const BoardObservations& observations,
                         const std::vector<CameraModel>& models);

/// The pose that most of `candidates` agree on: about the candidate with the least median distance
/// to the others, the median of those within three times that distance. Throws nothing; of no
/// candidates it is the identity.
Pose consensus_pose(const std::vector<Pose>& candidates);

}  // namespace vernier::internal
