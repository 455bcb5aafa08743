// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>

#include "calib/board_observations.h"
#include "calib/calibrate.h"

namespace vernier::internal {

/// Fewer frames are not divided to validate a calibration.
inline constexpr int fewest_frames_to_divide = 6;

/// How the boards stood while the cameras of a rig exposed one after the other.
enum class BoardStand {
  hand_held,  ///< they moved between the exposures, by as much as the views show
  still       ///< they did not, or the cameras are synchronised: no such motion is looked for
};

struct HeldOutBoardsOptions {
  int training_frames = 0;  ///< per split; 0: a little over half
  int splits = 100;
  std::uint64_t seed = 1;  ///< of the splits
  CalibrationOptions calibration;
  BoardStand stand = BoardStand::hand_held;
};

/// Coverage of intervals for lengths on boards that were not used in a calibration.
struct LengthCoverage {
  int lengths = 0;             ///< over all splits
  double coverage_honest = 0;  ///< fraction inside their 95 % interval, with `covariance`
  double coverage_mvb = 0;     ///< the same with the minimum variance bound
  double z_rms_honest = 0;     ///< root mean square of error over stated sigma; 1 if correct
  double z_rms_mvb = 0;
  double error_rms_m = 0;     ///< of the lengths themselves
  double sigma_honest_m = 0;  ///< root mean square of the stated sigmas
  double sigma_mvb_m = 0;
  double coverage_components = 0;  ///< with `covariance` and the components of the corner noise
  double z_rms_components = 0;
  double sigma_components_m = 0;
};

struct HeldOutBoardsResult {
  LengthCoverage edges;      ///< board rows, columns and diagonals end to end, one by one
  LengthCoverage scale;      ///< the board's overall size, all lengths of a board together
  int training_frames = 0;   ///< of each split
  int splits = 0;            ///< that could be calibrated
  int failed = 0;            ///< that could not
  int boards = 0;            ///< predictions of a board
  int boards_left_out = 0;   ///< fewer than four corners seen by both and triangulated, or no pose
  int corners_left_out = 0;  ///< not triangulated: diverging rays, or a pixel without a ray
  int noise_not_found = 0;   ///< splits whose fit of the corner noise did not converge
};

/// Validation on held-out boards: calibrates on some frames, triangulates the corners of the others
/// (calib/triangulation.h) and compares lengths on the board with their true values, over many
/// splits drawn from `seed`. Corners that cannot be triangulated are excluded and counted. A length
/// L(q, a) has the stated variance
///
///     J_a C_a J_aᵀ + σ² J_q J_qᵀ      or      J_a C_a J_aᵀ + J_q V_f J_qᵀ
///
/// C_a the rig's covariance, σ the calibration's pixel noise, V_f the noise of the corners of one
/// board by its components (calib/noise/corner_noise.h), found from the split's training frames
/// alone: errors that are alike over a board do not average out over it. `scale` is the weighted
/// mean of L over its true value on one board, in which pixel noise averages out but the rig's
/// error does not. Needs a pair and at least six frames seen by both cameras (else Error). Splits
/// share frames, so the coverages of two splits are not independent and no interval is given for
/// them.
HeldOutBoardsResult evaluate_held_out_boards(
    const BoardObservations& observations,
    const HeldOutBoardsOptions& options = {},
    const std::function<void(int done, int total)>& progress = {});

}  // namespace vernier::internal
