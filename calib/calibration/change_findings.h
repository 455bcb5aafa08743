// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/calibration/residual_diagnosis.h"
#include "calib/pair_observations.h"
#include "calib/rig.h"

namespace vernier::internal {

/// The doubt that cameras are not rigid, or not simultaneous: one change during the session if it
/// explains a quarter of Σ r² and nearly what a change in every frame does; otherwise a change in
/// every frame if it explains half (calib/calibration/frame_scatter.h). Good real sets reach 0.08
/// and 0.41, whatever their number of corners, since lens and board are never quite as modelled.
/// std::nullopt if neither; `state` as there. Where the board's motion between exposures is
/// estimated, another pose of a camera in every frame is no doubt.
std::optional<ResidualFinding> change_finding(const BoardObservations& observations,
                                              const BoardState& state,
                                              bool motion_is_estimated = false);

/// What changed between the image pairs of a calibration from matches.
struct PairChange {
  double shift_px = 0;  ///< rms displacement of the matches that it is equal to
  std::string text;     ///< cause, figures and remedy

  /// Smaller ones are in the covariance, which is clustered by image pair: a board held by hand
  /// before cameras that are not quite simultaneous leaves 0.2 px in a good real set.
  bool is_doubtful() const { return shift_px >= 0.5; }
};

/// The same of matched pairs, image pair by image pair, with the same limits; `inliers` and `rig`
/// as frame_scatter takes them.
std::optional<PairChange> change_finding(const PairObservations& inliers, const Rig& rig);

/// How the text of the following begins.
inline constexpr const char* bent_board_doubt = "the board is not flat: ";

/// The doubt that the board is bent: a warp (calib/board/board_warp.h), by a score test, explains
/// half of Σ r². `state` is a minimum with a known warp, without prior or held parameters.
std::optional<ResidualFinding> bent_board_finding(const BoardObservations& observations,
                                                  const BoardState& state);

}  // namespace vernier::internal
