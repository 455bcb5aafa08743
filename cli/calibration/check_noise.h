// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "calib/rig_estimate.h"
#include "calib/validation/held_out_boards.h"
#include "cli/calibration/check_section.h"
#include "cli/program/session.h"

namespace vernier::cli {

/// The components of a calibration's corner noise, and the frames between whose exposures the board
/// moved.
CheckSection check_corner_noise(const RigEstimate& estimate,
                                BoardStand stand,
                                const Session& session);

}  // namespace vernier::cli
