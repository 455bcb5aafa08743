// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/calibration/observation_checks.h"
#include "calib/camera.h"

namespace vernier::internal {

/// Places the boards of doubted frames for the state's rig.
void place_doubted(const std::vector<FrameDoubt>& doubts,
                   const BoardObservations& observations,
                   BoardState& state);

/// The start of a calibration (initial_state) from the frames that nothing is held against, with
/// the boards of the others placed for it; from all if those are fewer than half, or too few.
BoardState start_without(const std::vector<FrameDoubt>& doubts,
                         const BoardObservations& observations,
                         const std::vector<CameraModel>& models);

}  // namespace vernier::internal
