// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/board_target.h"
#include "calib/rig.h"

namespace vernier {

struct SimulatedBoardOptions {
  std::uint64_t seed = 1;   ///< of poses and noise
  std::uint32_t trial = 0;  ///< of the noise alone
  std::uint32_t poses = 0;  ///< number of the set of poses
  int frames = 20;
  double pixel_sigma_px = 0.2;  ///< white noise on each coordinate; 0 for none
  double distance_m = 1.0;      ///< of the board's centre, varied by a third either way
  double tilt_rad = 0.6;        ///< largest about x and y
};

struct SimulatedBoard {
  BoardObservations observations;
  BoardState truth;
};

/// Views of a chessboard that every camera of `rig` sees completely, with white noise, for tests
/// and planning. Poses are drawn by (seed, set of poses, frame), noise by (seed, trial, frame,
/// camera): trials differ in noise only, and fewer frames are the first of more. Throws Error if no
/// such view can be found in 1000 tries; for a board without two corners along each side, or with
/// more than 1000; a rig without cameras, or with a pose or a number missing; frames not from 1 to
/// 100000; and a distance that is not above 0, noise below 0, or a tilt that is not finite.
SimulatedBoard simulate_board(const Rig& rig,
                              const Chessboard& board,
                              const SimulatedBoardOptions& options = {});

}  // namespace vernier
