// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "calib/board_observations.h"
#include "calib/validation/left_out_boards.h"
#include "cli/calibration/check_part.h"
#include "cli/program/session.h"

namespace vernier::cli {

/// The shares inside their intervals and what goes with them.
Json coverage_json(const LengthCoverage& coverage);

/// Lengths on boards that took no part in the calibration against their intervals, over splits.
CheckPart check_boards_left_out(const BoardObservations& observations,
                                const LeftOutBoardsOptions& options,
                                const Session& session);

}  // namespace vernier::cli
