// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/rig_estimate.h"
#include "calib/validation/injected_error.h"
#include "cli/calibration/check_section.h"
#include "cli/program/session.h"

namespace vernier::cli {

/// Lengths on real and on simulated boards, by rigs that are wrong by known draws.
CheckSection check_injected(const RigEstimate& estimate,
                            const BoardObservations& observations,
                            const BoardState& state,
                            double pixel_sigma_px,
                            const InjectedErrorOptions& options,
                            const Session& session);

}  // namespace vernier::cli
