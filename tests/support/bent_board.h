// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "calib/board/board_warp.h"
#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/camera.h"
#include "calib/pose.h"
#include "calib/simulated_board.h"

namespace vernier::test {

using namespace vernier::internal;

/// The same views of a board whose points are these instead of the target's, with the same noise.
inline BoardObservations of_points(const SimulatedBoard& board,
                                   const std::vector<Eigen::Vector3d>& points_m) {
  BoardObservations seen = board.observations;
  std::size_t f = 0;
  for (BoardView& view : seen.views) {
    while (board.truth.frames[f] != view.frame) ++f;
    const Camera& camera = board.truth.rig.cameras[view.camera];
    const Pose T = board.truth.rig.T_camera_first[view.camera] * board.truth.T_first_board[f];
    for (std::size_t i = 0; i < view.ids.size(); ++i) {
      view.pixels_px[i] += project(camera, T * points_m[view.ids[i]]) -
                           project(camera, T * seen.target_m[view.ids[i]]);
    }
  }
  return seen;
}

/// The views with the board turned by 90 degrees about its normal, through its middle, in every
/// second frame, with the same noise.
inline SimulatedBoard turned(SimulatedBoard board) {
  const std::vector<Eigen::Vector3d>& target_m = board.observations.target_m;
  const Eigen::Vector3d middle = 0.5 * (target_m.front() + target_m.back());
  std::vector<Pose> poses = board.truth.T_first_board;
  for (std::size_t f = 1; f < poses.size(); f += 2) {
    Pose& T = poses[f];
    const Eigen::Vector3d at = T * middle;
    T.R = T.R * rotation_from_vector({0, 0, std::acos(0.0)});
    T.t = at - T.R * middle;
  }
  for (BoardView& view : board.observations.views) {
    const std::size_t f = frame_index(board.truth.frames, view.frame);
    const Camera& camera = board.truth.rig.cameras[view.camera];
    const Pose& T = board.truth.rig.T_camera_first[view.camera];
    for (std::size_t i = 0; i < view.ids.size(); ++i) {
      const Eigen::Vector3d& X = target_m[view.ids[i]];
      view.pixels_px[i] += project(camera, T * (poses[f] * X)) -
                           project(camera, T * (board.truth.T_first_board[f] * X));
    }
  }
  board.truth.T_first_board = std::move(poses);
  return board;
}

/// The same views of a board that is bent by `warp_m`, with the same noise.
inline BoardObservations bent(const SimulatedBoard& board, const Eigen::Vector2d& warp_m) {
  return of_points(board, warped_target(board.observations.target_m, warp_m));
}

}  // namespace vernier::test
