// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/interval.h"
#include "calib/rig_estimate.h"

namespace vernier::internal {

struct InjectedErrorOptions {
  std::vector<double> psi_c{1, 3, 10, 30};  ///< factors on the covariance's standard deviations
  int draws = 100;                          ///< wrong rigs of each factor
  std::uint64_t seed = 1;                   ///< of rigs and noise
  int threads = 0;                          ///< 0: all; does not affect results
};

/// What rigs that are wrong by a factor do to lengths on real boards and on simulated ones.
struct InjectedErrorLevel {
  double psi_c = 0;
  int draws = 0;   ///< rigs that were told
  int failed = 0;  ///< draws that no cameras can have, or that see too few corners
  double median_real = 0, median_simulated = 0;  ///< |error of a length| over the length
  Interval ratio_95;                             ///< of median_real ÷ median_simulated
  /// Of what the told rig changed in a board's size in reality, on what it changed in simulation,
  /// draw by draw and board by board, beside the rig as estimated: least squares through zero, and
  /// the correlation.
  double slope = 0, correlation = 0;
  Interval slope_95;

  double ratio() const { return median_real / median_simulated; }
};

struct InjectedErrorResult {
  int boards = 0;                          ///< frames in which both cameras saw the board
  double median_real = 0;                  ///< with the rig as it was estimated
  double median_simulated = 0;             ///< the same
  std::vector<InjectedErrorLevel> levels;  ///< in the order asked for
};

/// Tells the estimator rigs that are wrong by known draws of the covariance, triangulates real
/// corners with them (calib/triangulation.h), and compares the errors of lengths on the board with
/// those of the same boards simulated: corners as `state` predicts them, with white noise of
/// `pixel_sigma_px`, triangulated with the same wrong rigs. If the simulation is true, both medians
/// are alike at each factor, and each draw does in reality what it does in simulation.
///
/// The lengths' truth is the board, not the rig. Lengths are those of held-out boards
/// (held_out_boards.h); intervals by a bootstrap that resamples whole boards. Throws Error for
/// fewer than three boards seen by a pair, factors that are not above 0, or without a covariance.
InjectedErrorResult inject_calibration_error(
    const RigEstimate& estimate,
    const BoardObservations& observations,
    const BoardState& state,
    double pixel_sigma_px,
    const InjectedErrorOptions& options = {},
    const std::function<void(int done, int total)>& progress = {});

}  // namespace vernier::internal
