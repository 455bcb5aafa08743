// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "calib/board/board_warp.h"
#include "calib/board_observations.h"
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

/// The same views of a board that is bent by `warp_m`, with the same noise.
inline BoardObservations bent(const SimulatedBoard& board, const Eigen::Vector2d& warp_m) {
  return of_points(board, warped_target(board.observations.target_m, warp_m));
}

}  // namespace vernier::test
