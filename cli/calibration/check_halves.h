// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "calib/board_observations.h"
#include "calib/validation/split_halves.h"
#include "cli/calibration/check_section.h"
#include "cli/program/session.h"

namespace vernier::cli {

/// Means, degrees of freedom and the fraction of splits inside 95 %, for both covariances.
Json halves_json(const SplitHalvesResult& result);

/// What is doubtful about them, if anything.
std::vector<std::string> halves_doubts(const SplitHalvesResult& result);

/// Calibrations of random halves of the views, compared by their own covariances.
CheckSection check_halves(const BoardObservations& observations,
                          const SplitHalvesOptions& options,
                          const Session& session);

}  // namespace vernier::cli
