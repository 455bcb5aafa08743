// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/camera.h"
#include "calib/lens_models.h"
#include "calib/rig.h"
#include "calib/simulated_board.h"
#include "calib/solver/initial_rig.h"
#include "datasets/shipped.h"

namespace vernier::bench {

using namespace vernier::internal;

struct StereoProblem {
  BoardObservations observations;
  BoardState start;
};

/// Views of 100 corners visible in both cameras, opencv4, and the initial values of calibrate.
inline StereoProblem stereo_problem(int frames) {
  Rig rig = datasets::nominal_truth();
  for (Camera& camera : rig.cameras) {
    camera.model = OpenCv4{};
    const double k1 = camera.parameters[4];
    camera.parameters.conservativeResize(8);
    camera.parameters.tail<4>() << k1, 0.03, 4e-4, -3e-4;
  }
  const SimulatedBoardOptions options{.seed = 5, .frames = frames, .distance_m = 0.8};
  SimulatedBoard board = simulate_board(rig, {10, 10, 0.025}, options);
  BoardState start = initial_state(board.observations, {OpenCv4{}, OpenCv4{}});
  return {std::move(board.observations), std::move(start)};
}

}  // namespace vernier::bench
