// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/rig_and_boards.h"

namespace vernier::internal {

/// Linearised at `state`. A board whose warp is not zero had its warp estimated; that of a flat one
/// was held. Throws Error where the corners of a frame do not fix the pose of its board.
ConditionalBoardPoses conditional_board_poses(const BoardObservations& observations,
                                              const BoardState& state);

}  // namespace vernier::internal
