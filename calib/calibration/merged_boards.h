// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/joint_calibration.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"

namespace vernier::internal {

/// Board views of several calibrations merged into one: targets concatenated, frames renumbered,
/// noise expressed as weights. Terms with the same target are views of one board, whose warp
/// remains free if a calibration estimated it. With different targets, the warp estimated for each
/// is taken as known.
struct MergedBoards {
  BoardObservations observations;                   ///< no views if there is no term
  BoardState state;                                 ///< at the start
  std::vector<std::vector<double>> corner_weights;  ///< in [0, 1], or empty
  double pixel_sigma_px = 1;                        ///< of weight 1
  BoardWarp warp = BoardWarp::known;
  bool warps_assumed_known = false;  ///< of different boards, one of them bent
  struct Part {
    std::size_t first_frame = 0, frames = 0;
  };
  std::vector<Part> parts;  ///< one per term, indices into state.frames
};

/// Throws Error if the terms are of other cameras than `rig`.
MergedBoards merge_boards(const std::vector<BoardTerm>& terms, const Rig& rig);

/// The part of `state` that belongs to a term, in that term's own frames.
BoardState state_of(const MergedBoards& boards,
                    const std::vector<BoardTerm>& terms,
                    const BoardState& state,
                    std::size_t term);

/// The views as evidence of the joint calibration, with the poses of `state`.
CalibrationEvidence merged_evidence(const MergedBoards& boards, const BoardState& state);

}  // namespace vernier::internal
