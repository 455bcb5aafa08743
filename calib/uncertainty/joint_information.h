// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/rig_and_boards.h"

namespace vernier::internal {

/// Linearised at `state`. The warp counts as estimated if it is not zero, as fixed for a flat
/// board. Throws Error if the corners of a frame do not determine the pose of its board.
ConditionalBoardPoses conditional_board_poses(const BoardObservations& observations,
                                              const BoardState& state);

}  // namespace vernier::internal
