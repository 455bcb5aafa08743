// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "calib/board_observations.h"
#include "calib/validation/held_out_boards.h"
#include "cli/calibration/check_section.h"
#include "cli/program/session.h"

namespace vernier::cli {

/// Coverage of the intervals and related statistics.
Json coverage_json(const LengthCoverage& coverage);

/// Coverage of the predicted intervals for lengths on held-out boards, over random splits.
CheckSection check_held_out_boards(const BoardObservations& observations,
                                   const HeldOutBoardsOptions& options,
                                   const Session& session);

}  // namespace vernier::cli
