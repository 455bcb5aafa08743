// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "calib/board_observations.h"
#include "calib/validation/held_out_boards.h"
#include "cli/calibration/check_section.h"
#include "cli/program/session.h"

namespace vernier::cli {

/// The shares inside their intervals and what goes with them.
Json coverage_json(const LengthCoverage& coverage);

/// Lengths on boards that took no part in the calibration against their intervals, over splits.
CheckSection check_held_out_boards(const BoardObservations& observations,
                                   const HeldOutBoardsOptions& options,
                                   const Session& session);

}  // namespace vernier::cli
