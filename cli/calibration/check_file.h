// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "calib/rig_estimate.h"
#include "cli/calibration/check_section.h"

#include "cli/program/namespaces.h"

namespace vernier::cli {

/// Compares a file's parameters and minimum variance bound with `again`, the solution from its
/// stored evidence. If the calibration had a prior, gives the reason why they are not compared.
CheckSection check_file(const RigEstimate& from_file, const RigEstimate& again);

}  // namespace vernier::cli
