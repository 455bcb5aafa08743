// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/calibrate.h"
#include "calib/calibration/outliers.h"

namespace vernier::internal {

/// Copies the board poses of `other` at the frames that both have.
void replace_poses(BoardState& state, const BoardState& other);

/// The outliers under a sufficiently rich lens model, fitted to the corners that `fit` kept, and
/// its board poses; frames excluded as a whole first get a pose from `robust`. std::nullopt if
/// there is no such model or the views do not determine it.
std::optional<RobustFit> outliers_by_richer_lenses(const BoardObservations& observations,
                                                   const BoardState& robust,
                                                   const RobustFit& fit,
                                                   const CalibrationOptions& options);

}  // namespace vernier::internal
