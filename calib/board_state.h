// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "calib/pose.h"
#include "calib/rig.h"

namespace vernier {

/// Whether the board's warp is among the unknowns.
enum class BoardWarp { known, free };

/// A state of a board calibration: the rig and where the board stood in every frame.
struct BoardState {
  Rig rig;
  std::vector<int> frames;          ///< ascending
  std::vector<Pose> T_first_board;  ///< one a frame
  Eigen::Vector2d warp_m{0, 0};     ///< of the board (calib/board/board_warp.h)
};

/// Where `frame` is among `frames` (ascending), as those of a state are. Throws Error where it is
/// not among them.
std::size_t frame_index(const std::vector<int>& frames, int frame);

/// The state at some of its frames, ascending; frames it does not have are left out.
BoardState at_frames(const BoardState& state, const std::vector<int>& frames);

}  // namespace vernier
