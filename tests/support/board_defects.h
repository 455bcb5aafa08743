// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <utility>
#include <vector>

#include "calib/board_observations.h"
#include "calib/board_target.h"
#include "calib/camera.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "calib/simulated_board.h"

namespace vernier::test {

/// The view `camera` has of `frame`.
inline BoardView& view_of(BoardObservations& observations, int frame, int camera) {
  return *std::find_if(observations.views.begin(), observations.views.end(),
                       [&](const BoardView& v) { return v.frame == frame && v.camera == camera; });
}

/// Numbers the corners of every row from its other end.
inline void mirror(BoardView& view, int columns) {
  for (int& id : view.ids) id = id / columns * columns + columns - 1 - id % columns;
}

/// Numbers the corners from the last to the first: the board turned by half a turn.
inline void half_turn(BoardView& view) {
  const auto last = static_cast<int>(view.ids.size()) - 1;
  for (int& id : view.ids) id = last - id;
}

/// Exchanges what two cameras saw in a frame.
inline void exchange(BoardObservations& observations, int frame) {
  std::swap(view_of(observations, frame, 0).pixels_px, view_of(observations, frame, 1).pixels_px);
}

/// Adds a copy of a frame under another number.
inline void append_frame(BoardObservations& observations, int frame, int number) {
  std::vector<BoardView> copies;
  for (const BoardView& view : observations.views) {
    if (view.frame == frame) copies.push_back(view);
  }
  for (BoardView& copy : copies) {
    copy.frame = number;
    observations.views.push_back(std::move(copy));
  }
}

/// Twelve frames of a board that stands at the given rotations only (rotation vectors, in turn), at
/// other places each time: those of a simulation, with its noise of 0.2 px.
inline BoardObservations board_at_tilts(const Rig& rig,
                                        const Chessboard& board,
                                        std::uint64_t seed,
                                        const std::vector<Eigen::Vector3d>& tilts) {
  SimulatedBoard drawn = simulate_board(rig, board, {.seed = seed, .frames = 40, .tilt_rad = 0});
  BoardObservations& observations = drawn.observations;
  std::vector<BoardView> kept;
  int frames = 0;
  const Eigen::Vector3d centre =
      0.5 * (observations.target_m.front() + observations.target_m.back());
  for (int frame = 0; frame < 40 && frames < 12; ++frame) {
    Pose T_first_board = drawn.truth.T_first_board[frame];
    const Eigen::Vector3d at = T_first_board * centre;
    T_first_board.R = rotation_from_vector(tilts[frames % tilts.size()]);
    T_first_board.t = at - T_first_board.R * centre;
    std::vector<BoardView> views;
    for (int c = 0; c < static_cast<int>(rig.cameras.size()); ++c) {
      BoardView view = view_of(observations, frame, c);
      const Pose& before = drawn.truth.T_first_board[frame];
      bool inside = true;
      for (std::size_t i = 0; i < view.ids.size(); ++i) {
        const Eigen::Vector3d& X = observations.target_m[view.ids[i]];
        const auto pixel = [&](const Pose& T) {
          return project(rig.cameras[c], rig.T_camera_first[c] * (T * X));
        };
        view.pixels_px[i] += pixel(T_first_board) - pixel(before);
        inside &= in_image(rig.cameras[c], view.pixels_px[i]);
      }
      view.frame = frames;
      if (inside) views.push_back(std::move(view));
    }
    if (views.size() != rig.cameras.size()) continue;
    ++frames;
    kept.insert(kept.end(), views.begin(), views.end());
  }
  observations.views = std::move(kept);
  return observations;
}

}  // namespace vernier::test
