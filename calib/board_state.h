// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "calib/pose.h"
#include "calib/rig.h"

namespace vernier {

/// Whether the board's warp is estimated.
enum class BoardWarp { known, free };

/// State of a board calibration: the rig and the pose of the board in every frame.
struct BoardState {
  Rig rig;
  std::vector<int> frames;          ///< ascending
  std::vector<Pose> T_first_board;  ///< one per frame
  Eigen::Vector2d warp_m{0, 0};     ///< of the board (calib/board/board_warp.h)
};

/// Index of `frame` in `frames` (ascending). Throws Error if it is not there.
std::size_t frame_index(const std::vector<int>& frames, int frame);

/// The state at the given frames (ascending); frames it does not have are ignored.
BoardState at_frames(const BoardState& state, const std::vector<int>& frames);

}  // namespace vernier
