// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/calibration/doubted_frames.h"

#include <cstddef>

#include "calib/board/board_pose.h"
#include "calib/board/board_warp.h"
#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/calibration/observation_checks.h"
#include "calib/calibration/view_checks.h"
#include "calib/camera.h"
#include "calib/error.h"
#include "calib/pose.h"
#include "calib/solver/initial_rig.h"

namespace vernier::internal {

void place_doubted(const std::vector<FrameDoubt>& doubts,
                   const BoardObservations& observations,
                   BoardState& state) {
  const auto target_m = warped_target(observations.target_m, state.warp_m);
  for (const FrameDoubt& doubt : doubts) {
    const std::vector<BoardView> views = at_frames(observations, {doubt.frame}).views;
    state.T_first_board[frame_index(state.frames, doubt.frame)] =
        find_board_pose(target_m, views, state.rig).T_first_board;
  }
}

BoardState start_without(const std::vector<FrameDoubt>& doubts,
                         const BoardObservations& observations,
                         const std::vector<CameraModel>& models) {
  const std::vector<int> all = frames_of(observations), sound = frames_without(doubts, all);
  if (sound.size() == all.size() || 2 * sound.size() < all.size()) {
    return initial_state(observations, models);
  }
  try {
    const BoardState start = initial_state(at_frames(observations, sound), models);
    BoardState state = start;
    state.frames = all;
    state.T_first_board.assign(all.size(), Pose{});
    for (std::size_t f = 0; f < sound.size(); ++f) {
      state.T_first_board[frame_index(all, sound[f])] = start.T_first_board[f];
    }
    place_doubted(doubts, observations, state);
    return state;
  } catch (const Error&) {  // too few views of a camera
    return initial_state(observations, models);
  }
}

}  // namespace vernier::internal
