// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "calib/board_observations.h"
#include "calib/rig.h"

namespace vernier {

/// A state of a board calibration: the rig and where the board stood in every frame.
struct BoardState {
  Rig rig;
  std::vector<int> frames;          ///< ascending
  std::vector<Pose> T_first_board;  ///< one a frame
  Eigen::Vector2d warp_m{0, 0};     ///< of the board (calib/board_warp.h)
};

/// The state at some of its frames, ascending; frames it does not have are left out.
BoardState at_frames(const BoardState& state, const std::vector<int>& frames);

/// A start from the corners alone: focal lengths from the homographies' vanishing points with the
/// centre in the middle of the image and no distortion (Zhang 2000, as OpenCV does it), poses by
/// PnP, the cameras chained by their common frames. Throws Error where a camera shares no frame
/// with those before it, or where no focal length can be had (every board parallel to the image).
BoardState initial_state(const BoardObservations& observations,
                         const std::vector<CameraModel>& models);

}  // namespace vernier
