// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "calib/board_observations.h"
#include "calib/board_state.h"

namespace vernier::internal {

/// The noise that moves parameters: the part of the residuals that varies smoothly over the board.
struct SmoothNoise {
  double sd_px = 0;      ///< of a smooth mode of unit length
  double log_sd = 0;     ///< standard deviation of its logarithm
  double inflation = 1;  ///< its square over the mean square of all residuals: 1 if these are white
};

/// A calibration's parameters, and the poses of its boards, move whole views smoothly; corner noise
/// that is independent from corner to corner has only its share in such motions, noise that is
/// correlated has more. With Q an orthonormal basis of the polynomials up to degree three in the
/// board's plane (for each camera and coordinate of a view) and r the residuals,
///
///     sd² = Σ_f |Qᵀ r_f|² / Σ_f (modes of f − 6 − p/F)
///
/// because the 6 parameters of a pose and each view's share of the p of the rig are smooth too and
/// have been fitted. There are some 30 such modes a frame of a pair, far more than parameters, so
/// that few views suffice. The standard error is the larger of that of white noise and that of the
/// scatter between frames.
SmoothNoise smooth_noise(const BoardObservations& observations,
                         const BoardState& state,
                         int parameters);

}  // namespace vernier::internal
